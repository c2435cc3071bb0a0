// Random sequences of calls, seeded by their number: no crash, the statuses that the documentation promises, and arrays
// that nobody writes to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "api_test_tools.h"
#include "call_model.h"

namespace insitu {
namespace {

using testing::CallModel;
using testing::ModelImage;
using testing::ModelSet;
using testing::SplitMix64;

constexpr std::size_t most_particles = 120;

// FNV-1a: the bytes in their order.
std::uint64_t hash_of(const void* bytes, std::size_t count) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (std::size_t i = 0; i < count; ++i) hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3;
  return hash;
}

struct Record {
  double x[3];
  float heat;
  float radius;
  std::int32_t type;
  std::uint32_t id;
};

// The memory of one set: records that stay allocated, of which some are handed over.
struct Data {
  explicit Data(SplitMix64& random) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      for (double& x : records[i].x) x = random.unit();
      records[i].heat = static_cast<float>(random.unit());
      records[i].radius = random.below(20) == 0 ? -1.0f : 0.05f;
      records[i].type = static_cast<std::int32_t>(random.below(3));
      records[i].id = static_cast<std::uint32_t>(i);
    }
  }
  std::uint64_t hash() const { return hash_of(records.data(), sizeof records); }
  // The same for every order of the records.
  std::uint64_t sum() const {
    std::uint64_t sum = 0;
    for (const Record& record : records) sum += hash_of(&record, sizeof record) | 1;
    return sum;
  }
  std::array<Record, most_particles> records;
};

// A run of calls against one context, with the model beside it.
class Sequence {
 public:
  Sequence(std::uint64_t seed, bool legal)
      : random_(seed),
        legal_(legal),
        context_(static_cast<std::uint32_t>(1 + random_.below(2)), 0, 0, static_cast<std::uint32_t>(random_.below(3))) {
  }

  void calls(int count) {
    for (int i = 0; i < count && !::testing::Test::HasFailure(); ++i) one_call();
    // Whatever has happened, a step can be ended and the next one works.
    if (model_.in_step) step_end();
    model_.sets.clear();
  }

 private:
  // ------------------------------------------------------------------------------------------------ what is checked --
  void expect(const char* what, insitu_status status, insitu_status expected) {
    EXPECT_EQ(status, expected) << what << ": " << insitu_status_name(status) << " instead of "
                                << insitu_status_name(expected) << "; the last text: " << context_.error();
  }

  // For calls that may find one of several things wrong. True when all went well.
  template <class Body>
  bool expect_any(const char* what, const std::vector<insitu_status>& problems, const Body& body) {
    const bool listens = model_.listens();
    const insitu_status status = body();
    if (!listens) {
      expect(what, status, model_.sticky);
    } else if (problems.empty()) {
      expect(what, status, INSITU_OK);
    } else {
      EXPECT_THAT(problems, ::testing::Contains(status)) << what << "; the last text: " << context_.error();
    }
    return model_.call(status) == INSITU_OK;
  }

  // Runs `body`; no array may change in it, except, where `may_move`, the order of records of sets with PERMUTE.
  template <class Body>
  insitu_status guarded(bool may_move, const Body& body) {
    struct Before {
      std::uint64_t hash;
      std::uint64_t sum;
    };
    std::vector<Before> before;
    for (const auto& data : data_) before.push_back({data->hash(), data->sum()});
    const insitu_status status = body();
    for (std::size_t i = 0; i < data_.size(); ++i) {
      const bool moves = may_move && model_.sets[i].order == INSITU_ORDER_PERMUTE && model_.sets[i].bound;
      if (moves) {
        EXPECT_EQ(data_[i]->sum(), before[i].sum) << "records of set " << i;
      } else {
        EXPECT_EQ(data_[i]->hash(), before[i].hash) << "arrays of set " << i;
      }
    }
    return status;
  }

  // ----------------------------------------------------------------------------------------------- what is picked from
  // -- An object of a kind, or, unless all has to be legal, something that is none.
  struct Pick {
    std::uint64_t id = 0;
    int index = -1;  // into the model; -1: no such object
  };
  Pick pick(const std::vector<std::uint64_t>& ids, const std::vector<bool>& alive) {
    if (!legal_ && random_.below(12) == 0) {
      const std::uint64_t wrong[] = {0, 1, ~std::uint64_t{0}, random_.next(), foreign_id()};
      return {wrong[random_.below(5)], -1};
    }
    std::vector<int> choices;
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (alive[i] || (!legal_ && random_.below(8) == 0)) choices.push_back(static_cast<int>(i));
    if (choices.empty()) return {0, -1};
    const int index = choices[random_.below(choices.size())];
    const auto at = static_cast<std::size_t>(index);
    return {ids[at], alive[at] ? index : -1};
  }
  // An id of another kind, or of an object that is gone.
  std::uint64_t foreign_id() {
    for (const auto* ids : {&view_ids_, &image_ids_, &set_ids_, &colormap_ids_})
      if (!ids->empty() && random_.below(2) == 0) {
        // Turned into one of another generation.
        return (*ids)[random_.below(ids->size())] ^ (std::uint64_t{1} << 40);
      }
    return 2;
  }
  Pick pick_set() {
    std::vector<bool> alive;
    for (const ModelSet& set : model_.sets) alive.push_back(set.alive);
    return pick(set_ids_, alive);
  }
  Pick pick_view() { return pick(view_ids_, model_.views); }
  Pick pick_image() {
    std::vector<bool> alive;
    for (const ModelImage& image : model_.images) alive.push_back(image.alive);
    return pick(image_ids_, alive);
  }
  ModelSet& set_of(const Pick& pick) { return model_.sets[static_cast<std::size_t>(pick.index)]; }

  // --------------------------------------------------------------------------------------------------------- the calls
  // --
  void one_call() {
    using Call = void (Sequence::*)();
    static constexpr Call all[] = {
        &Sequence::create_set,   &Sequence::update,        &Sequence::update,     &Sequence::update,
        &Sequence::permutation,  &Sequence::restore,       &Sequence::set_style,  &Sequence::bounds,
        &Sequence::set_filter,   &Sequence::destroy_set,   &Sequence::create_map, &Sequence::destroy_map,
        &Sequence::create_view,  &Sequence::change_view,   &Sequence::fit,        &Sequence::destroy_view,
        &Sequence::create_image, &Sequence::render,        &Sequence::render,     &Sequence::write,
        &Sequence::channel,      &Sequence::destroy_image, &Sequence::step_begin, &Sequence::step_begin,
        &Sequence::commit,       &Sequence::commit,        &Sequence::step_end,   &Sequence::stats};
    (this->*all[random_.below(std::size(all))])();
  }

  // Of what needs a scene to look at: ids are judged first.
  std::vector<insitu_status> problems_with(std::initializer_list<Pick> picks) const {
    for (const Pick& pick : picks)
      if (pick.index < 0) return {INSITU_ERROR_INVALID_HANDLE};
    return model_.scene_problems();
  }

  // The legal ones call only what can be called now.
  bool skip(insitu_status expected) const { return legal_ && expected != INSITU_OK; }

  void create_set() {
    if (model_.sets.size() >= 12) return;
    ModelSet set;
    set.order = static_cast<std::uint32_t>(random_.below(3));
    set.keeps = random_.below(2) == 0;
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.order = set.order;
    desc.flags = set.keeps ? INSITU_PARTICLES_KEEP_PERMUTATION : 0;
    insitu_status expected = INSITU_OK;
    if (!legal_ && random_.below(10) == 0) {
      desc.order = 17;
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    insitu_geometry geometry = {1};
    const insitu_status result = model_.call(expected);
    expect("particles_create", insitu_particles_create(context_, &desc, &geometry), result);
    if (result != INSITU_OK) {
      EXPECT_EQ(geometry.id, 0u);
      return;
    }
    data_.push_back(std::make_unique<Data>(random_));
    hash_at_update_.push_back(0);
    set_ids_.push_back(geometry.id);
    model_.sets.push_back(set);
  }

  void update() {
    const Pick pick = pick_set();
    Data spare(random_);
    Record* records =
        pick.index < 0 ? spare.records.data() : data_[static_cast<std::size_t>(pick.index)]->records.data();
    const std::uint64_t sizes[] = {0, 1, 2, 31, 33, most_particles, random_.below(most_particles)};
    const std::uint64_t count = sizes[random_.below(7)];
    const bool with_heat = random_.below(4) != 0;
    const auto field = [&](std::uint32_t type, std::uint32_t components, const void* first) {
      insitu_array array = insitu_array_records(type, components, count == 0 ? nullptr : first, count, sizeof(Record));
      array.flags = INSITU_ARRAY_PERMUTABLE;
      return array;
    };
    insitu_array position = field(INSITU_F64, 3, records->x);
    insitu_array heat = field(INSITU_F32, 1, &records->heat);
    insitu_array radius = field(INSITU_F32, 1, &records->radius);
    const insitu_array type = field(INSITU_I32, 1, &records->type);
    const insitu_array id = field(INSITU_U32, 1, &records->id);
    // What is no attribute has to move along all the same.
    const insitu_array* payload[2] = {&id, &heat};
    const insitu_attribute attribute = {"heat", &heat};
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.radius = &radius;
    desc.type = &type;
    desc.attributes = &attribute;
    desc.attribute_count = with_heat ? 1 : 0;
    desc.payload = payload;
    desc.payload_count = with_heat ? 1 : 2;

    insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : model_.needs_step();
    if (!legal_ && expected == INSITU_OK && random_.below(6) == 0) {
      expected = INSITU_ERROR_INVALID_ARGUMENT;
      switch (random_.below(5)) {
        case 0:
          desc.position = nullptr;
          break;
        case 1:
          radius.count = count + 1;
          break;
        case 2:
          position.components = 2;
          break;
        case 3:
          desc.radius_scale = -1.0;
          break;
        default:
          position.flags = 1u << 30;
          break;
      }
    }
    // Once the set is bound under PERMUTE and moved, the same records may be handed over again: a new beginning.
    if (skip(expected)) return;
    const bool listens = model_.listens();
    const insitu_status result = model_.call(expected);
    expect("update", guarded(false, [&] { return insitu_particles_update(context_, {pick.id}, &desc); }), result);
    if (!listens || result != INSITU_OK) return;
    hash_at_update_[static_cast<std::size_t>(pick.index)] = data_[static_cast<std::size_t>(pick.index)]->hash();
    ModelSet& set = set_of(pick);
    set.bound = true;
    set.built = false;
    set.has_heat = with_heat;
    set.count = count;
  }

  void permutation() {
    const Pick pick = pick_set();
    insitu_status expected = INSITU_ERROR_INVALID_HANDLE;
    std::uint64_t room = most_particles;
    if (pick.index >= 0) {
      const ModelSet& set = set_of(pick);
      expected = model_.needs_commit();
      if (expected == INSITU_OK && !(set.bound && set.built)) expected = INSITU_ERROR_WRONG_STATE;
      if (!legal_ && expected == INSITU_OK && set.count > 0 && random_.below(4) == 0) {
        room = set.count - 1;
        expected = INSITU_ERROR_INVALID_ARGUMENT;
      } else if (expected == INSITU_OK && set.order == INSITU_ORDER_PERMUTE && !set.keeps) {
        expected = INSITU_ERROR_WRONG_STATE;
      }
    }
    if (skip(expected)) return;
    std::array<std::uint64_t, most_particles> original;
    original.fill(~std::uint64_t{0});
    const insitu_status result = model_.call(expected);
    expect("permutation",
           guarded(false, [&] { return insitu_particles_permutation(context_, {pick.id}, original.data(), room); }),
           result);
    if (result != INSITU_OK) return;
    const std::size_t count = set_of(pick).count;
    std::sort(original.begin(), original.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(original[i], i);
  }

  void restore() {
    const Pick pick = pick_set();
    insitu_status expected = INSITU_ERROR_INVALID_HANDLE;
    if (pick.index >= 0) {
      const ModelSet& set = set_of(pick);
      expected = model_.needs_commit();
      if (set.order != INSITU_ORDER_PERMUTE || !set.keeps || !set.bound || !set.built)
        expected = INSITU_ERROR_WRONG_STATE;
    }
    if (skip(expected)) return;
    const insitu_status result = model_.call(expected);
    expect("restore_order",
           guarded(result == INSITU_OK, [&] { return insitu_particles_restore_order(context_, {pick.id}); }), result);
    if (result != INSITU_OK) return;
    const auto index = static_cast<std::size_t>(pick.index);
    EXPECT_EQ(data_[index]->hash(), hash_at_update_[index]) << "every record is back in its place";
    set_of(pick).bound = set_of(pick).built = false;
  }

  void set_style() {
    const Pick pick = pick_set();
    const bool by_heat = random_.below(2) == 0;
    insitu_style style;
    insitu_style_init(&style);
    style.color_by = by_heat ? INSITU_COLOR_ATTRIBUTE : INSITU_COLOR_UNIFORM;
    style.attribute = "heat";
    if (random_.below(3) == 0) style.opacity = 0.5;
    const char* maps[] = {nullptr, "viridis", "categorical", "no such map"};
    style.colormap = maps[random_.below(legal_ ? 3 : 4)];
    int own_map = -1;
    insitu_status map_status = INSITU_OK;
    if (random_.below(4) == 0) {
      const Pick map = this->pick(colormap_ids_, model_.colormaps);
      if (map.id != 0) {
        style.own_map.id = map.id;
        own_map = map.index;
        if (map.index < 0) map_status = INSITU_ERROR_INVALID_HANDLE;
      }
    }
    insitu_status expected = INSITU_OK;
    if (pick.index < 0) {
      expected = INSITU_ERROR_INVALID_HANDLE;
    } else if (style.own_map.id == 0 && style.colormap == maps[3]) {
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    } else if (map_status != INSITU_OK) {
      expected = map_status;
    } else if (set_of(pick).bound && by_heat && !set_of(pick).has_heat) {
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    if (skip(expected)) return;
    const insitu_status result = model_.call(expected);
    expect("set_style", guarded(false, [&] { return insitu_geometry_set_style(context_, {pick.id}, &style); }), result);
    if (result != INSITU_OK) return;
    set_of(pick).styled_by_heat = by_heat;
    set_of(pick).colormap = own_map;
  }

  void set_filter() {
    const Pick pick = pick_set();
    const bool by_heat = random_.below(2) == 0;
    const std::int32_t members[] = {0, 2};
    insitu_array set = insitu_array_records(INSITU_I32, 1, members, 2, 0);
    insitu_filter_term terms[3];
    for (insitu_filter_term& term : terms) {
      insitu_filter_term_init(&term);
      term.kind = INSITU_FILTER_BOX;
      term.upper[0] = term.upper[1] = term.upper[2] = random_.unit();
      term.flags = random_.below(2) == 0 ? std::uint32_t{INSITU_FILTER_NOT} : 0u;
      term.alternative = static_cast<std::uint32_t>(random_.below(2));
    }
    terms[1].kind = by_heat ? INSITU_FILTER_RANGE : INSITU_FILTER_SET;
    terms[1].attribute = by_heat ? "heat" : "type";
    terms[1].range[1] = 0.5;
    terms[1].set = &set;
    insitu_filter filter;
    insitu_filter_init(&filter);
    filter.terms = terms;
    filter.term_count = static_cast<std::uint32_t>(random_.below(4));
    const bool asks_for_heat = by_heat && filter.term_count > 1;
    insitu_status expected = INSITU_OK;
    if (pick.index < 0) {
      expected = INSITU_ERROR_INVALID_HANDLE;
    } else if (!legal_ && random_.below(6) == 0) {
      filter.term_count = 3;
      terms[2].kind = 99;
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    } else if (set_of(pick).bound && asks_for_heat && !set_of(pick).has_heat) {
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    if (skip(expected)) return;
    const insitu_status result = model_.call(expected);
    expect("set_filter", guarded(false, [&] { return insitu_particles_set_filter(context_, {pick.id}, &filter); }),
           result);
    if (result == INSITU_OK) set_of(pick).filtered_by_heat = asks_for_heat;
  }

  void bounds() {
    const Pick pick = pick_set();
    double lower[3];
    double upper[3];
    const insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : model_.needs_commit();
    if (skip(expected)) return;
    const insitu_status result = model_.call(expected);
    expect("bounds", insitu_geometry_bounds(context_, {pick.id}, lower, upper), result);
    if (result == INSITU_OK && !set_of(pick).bound) {
      EXPECT_GT(lower[0], upper[0]);
    }
  }

  void destroy_set() {
    if (random_.below(3) != 0) return;
    const Pick pick = pick_set();
    const insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    if (skip(expected)) return;
    const insitu_status result = model_.always(expected);
    expect("geometry_destroy", guarded(false, [&] { return insitu_geometry_destroy(context_, {pick.id}); }), result);
    if (result == INSITU_OK) set_of(pick) = {.alive = false};
  }

  void create_map() {
    const double colors[8] = {0.0, 0.5, 1.0, 1.0, 1.0, 0.0, 0.0, 0.25};
    insitu_colormap_desc desc;
    insitu_colormap_desc_init(&desc);
    desc.rgba = colors;
    desc.count = 2;
    insitu_status expected = INSITU_OK;
    if (!legal_ && random_.below(5) == 0) {
      desc.count = 0;
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    insitu_colormap map = {1};
    const insitu_status result = model_.call(expected);
    expect("colormap_create", insitu_colormap_create(context_, &desc, &map), result);
    if (result != INSITU_OK) return;
    colormap_ids_.push_back(map.id);
    model_.colormaps.push_back(true);
  }

  // Legal sequences leave maps alone that a style still refers to.
  void destroy_map() {
    const Pick pick = this->pick(colormap_ids_, model_.colormaps);
    const insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    if (skip(expected)) return;
    if (legal_)
      for (const ModelSet& set : model_.sets)
        if (set.alive && set.colormap == pick.index) return;
    const insitu_status result = model_.always(expected);
    expect("colormap_destroy", insitu_colormap_destroy(context_, {pick.id}), result);
    if (result == INSITU_OK) model_.colormaps[static_cast<std::size_t>(pick.index)] = false;
  }

  void create_view() {
    if (model_.views.size() >= 8) return;
    insitu_view view = {1};
    const insitu_status result = model_.call(INSITU_OK);
    expect("view_create", insitu_view_create(context_, nullptr, &view), result);
    if (result != INSITU_OK) return;
    view_ids_.push_back(view.id);
    model_.views.push_back(true);
  }

  void change_view() {
    const Pick pick = pick_view();
    insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    if (skip(expected)) return;
    const bool bad = !legal_ && pick.index >= 0 && random_.below(5) == 0;
    if (bad) expected = INSITU_ERROR_INVALID_ARGUMENT;
    const insitu_status result = model_.call(expected);
    insitu_effects effects;
    insitu_effects_init(&effects);
    insitu_camera camera;
    insitu_camera_init(&camera);
    const double color[4] = {0.2, 0.3, 0.4, bad ? 2.0 : 0.5};
    switch (random_.below(4)) {
      case 0:
        effects.flags = bad ? 64 : static_cast<std::uint32_t>(random_.below(4));
        effects.ao_samples = 1;
        return expect("set_effects", insitu_view_set_effects(context_, {pick.id}, &effects), result);
      case 1:
        camera.kind = bad ? 5 : static_cast<std::uint32_t>(random_.below(2));
        camera.eye[2] = 3.0;
        return expect("set_camera", insitu_view_set_camera(context_, {pick.id}, &camera), result);
      case 2:
        return expect("set_background", insitu_view_set_background(context_, {pick.id}, color), result);
      default:
        return expect("turn", insitu_view_turn(context_, {pick.id}, bad ? 1e308 * 10.0 : 33.0), result);
    }
  }

  void fit() {
    const Pick pick = pick_view();
    const std::vector<insitu_status> problems = problems_with({pick});
    if (legal_ && !problems.empty()) return;
    expect_any("fit", problems,
               [&] { return guarded(false, [&] { return insitu_view_fit(context_, {pick.id}, 1.25); }); });
  }

  void destroy_view() {
    if (random_.below(3) != 0) return;
    const Pick pick = pick_view();
    const insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    if (skip(expected)) return;
    expect("view_destroy", insitu_view_destroy(context_, {pick.id}), model_.always(expected));
    if (expected == INSITU_OK) model_.views[static_cast<std::size_t>(pick.index)] = false;
  }

  void create_image() {
    if (model_.images.size() >= 8) return;
    insitu_image_desc desc;
    insitu_image_desc_init(&desc);
    desc.width = static_cast<std::uint32_t>(1 + random_.below(20));
    desc.height = static_cast<std::uint32_t>(1 + random_.below(20));
    desc.samples_per_pixel = 1;
    desc.channels = static_cast<std::uint32_t>(random_.below(32));
    insitu_status expected = INSITU_OK;
    if (!legal_ && random_.below(5) == 0) {
      desc.channels = 1u << 20;
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    insitu_image image = {1};
    const insitu_status result = model_.call(expected);
    expect("image_create", insitu_image_create(context_, &desc, &image), result);
    if (result != INSITU_OK) return;
    image_ids_.push_back(image.id);
    model_.images.emplace_back();
  }

  void render() {
    const Pick view = pick_view();
    const Pick image = pick_image();
    const std::vector<insitu_status> problems = problems_with({view, image});
    if (legal_ && !problems.empty()) return;
    const bool rendered = expect_any("render", problems, [&] {
      return guarded(false, [&] { return insitu_render(context_, {view.id}, {image.id}); });
    });
    if (rendered) model_.images[static_cast<std::size_t>(image.index)].rendered = true;
  }

  void write() {
    if (random_.below(4) != 0) return;
    const Pick image = pick_image();
    const std::string good = folder_.file("image.png");
    const std::string nowhere = folder_.file("none/image.png");
    const bool to_nowhere = !legal_ && random_.below(3) == 0;
    insitu_status expected = INSITU_ERROR_INVALID_HANDLE;
    if (image.index >= 0) {
      const bool rendered = model_.images[static_cast<std::size_t>(image.index)].rendered;
      expected = !rendered ? INSITU_ERROR_WRONG_STATE : to_nowhere ? INSITU_ERROR_IO : INSITU_OK;
    }
    if (skip(expected)) return;
    expect("write", insitu_image_write(context_, {image.id}, (to_nowhere ? nowhere : good).c_str()),
           model_.call(expected));
  }

  void channel() {
    const Pick image = pick_image();
    insitu_array array;
    insitu_array_init(&array);
    insitu_status expected = image.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    std::uint32_t which = INSITU_CHANNEL_COLOR;
    if (!legal_ && image.index >= 0 && random_.below(4) == 0) {
      which = 3;
      expected = INSITU_ERROR_INVALID_ARGUMENT;
    }
    if (skip(expected)) return;
    const insitu_status result = model_.call(expected);
    expect("channel", insitu_image_channel(context_, {image.id}, which, &array), result);
    if (result != INSITU_OK) return;
    float sum = 0.0f;
    for (std::uint64_t i = 0; i < 4 * array.count; ++i) sum += static_cast<const float*>(array.component[0])[i];
    EXPECT_GE(sum, 0.0f);
  }

  void destroy_image() {
    if (random_.below(3) != 0) return;
    const Pick pick = pick_image();
    const insitu_status expected = pick.index < 0 ? INSITU_ERROR_INVALID_HANDLE : INSITU_OK;
    if (skip(expected)) return;
    expect("image_destroy", insitu_image_destroy(context_, {pick.id}), model_.always(expected));
    if (expected == INSITU_OK) model_.images[static_cast<std::size_t>(pick.index)].alive = false;
  }

  void step_begin() {
    const insitu_status expected = model_.in_step ? INSITU_ERROR_WRONG_STATE : INSITU_OK;
    if (skip(expected)) return;
    expect("step_begin", insitu_step_begin(context_, random_.next(), random_.unit()), model_.call(expected));
    if (expected == INSITU_OK) model_.in_step = true;
  }

  void commit() {
    const std::vector<insitu_status> problems = model_.commit_problems();
    if (legal_ && !problems.empty()) return;
    const bool may_move = model_.listens() && problems.empty();
    const bool committed =
        expect_any("commit", problems, [&] { return guarded(may_move, [&] { return insitu_commit(context_); }); });
    if (!committed) return;
    model_.committed = true;
    for (ModelSet& set : model_.sets) set.built = set.bound;
  }

  void step_end() {
    const insitu_status expected = model_.in_step ? model_.sticky : INSITU_ERROR_WRONG_STATE;
    if (legal_ && !model_.in_step) return;
    expect("step_end", guarded(false, [&] { return insitu_step_end(context_); }), expected);
    if (model_.in_step) model_.end_step();
  }

  void stats() {
    const insitu_stats stats = context_.stats();
    EXPECT_LE(stats.owned_bytes, stats.peak_bytes);
    EXPECT_LE(stats.items_skipped, stats.items);
  }

  SplitMix64 random_;
  bool legal_;
  testing::Context context_;
  testing::TemporaryFolder folder_;
  CallModel model_;
  std::vector<std::unique_ptr<Data>> data_;  // one for each set of the model
  std::vector<std::uint64_t> hash_at_update_;
  std::vector<std::uint64_t> set_ids_;
  std::vector<std::uint64_t> view_ids_;
  std::vector<std::uint64_t> image_ids_;
  std::vector<std::uint64_t> colormap_ids_;
};

constexpr std::uint64_t sequences = testing::sanitized ? 200 : 500;

TEST(RandomCalls, Legal) {
  for (std::uint64_t seed = 0; seed < sequences && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Sequence(seed, true).calls(200);
  }
}

TEST(RandomCalls, AlsoIllegal) {
  for (std::uint64_t seed = 0; seed < sequences && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Sequence(1000000 + seed, false).calls(200);
  }
}

}  // namespace
}  // namespace insitu
