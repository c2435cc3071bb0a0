// Pictures of filtered sets: those of the particles that are left, given alone, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "filter_terms.h"
#include "glyph_scenes.h"

namespace insitu::testing {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Grains {
  std::vector<double> xyz;
  std::vector<double> heat;
  std::vector<double> radius;
  std::vector<std::int64_t> id;
  std::vector<std::int32_t> kind;

  explicit Grains(std::size_t count) {
    SplitMix64 random(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c) xyz.push_back(random.unit());
      heat.push_back(random.unit());
      radius.push_back(0.02 + 0.03 * random.unit());
      id.push_back((std::int64_t{1} << 53) + static_cast<std::int64_t>(i));
      kind.push_back(static_cast<std::int32_t>(random.below(4)));
    }
  }
  std::size_t count() const { return heat.size(); }
  Grains left(const std::function<bool(std::size_t)>& keep) const {
    Grains some(0);
    for (std::size_t i = 0; i < count(); ++i) {
      if (!keep(i)) continue;
      some.xyz.insert(some.xyz.end(), &xyz[3 * i], &xyz[3 * i] + 3);
      some.heat.push_back(heat[i]);
      some.radius.push_back(radius[i]);
      some.id.push_back(id[i]);
      some.kind.push_back(kind[i]);
    }
    return some;
  }
};

struct Manner {
  std::uint32_t order = INSITU_ORDER_INDEX;
  double treelet_share = 0.0;
  bool fixed_camera = true;
  const insitu_cell* cell = nullptr;
  std::uint32_t threads = 2;
};

// A set that can be drawn again and again within one step.
class Stage {
 public:
  Stage(Grains grains, const Manner& manner) : grains_(std::move(grains)), context_(manner.threads) {
    const insitu_camera camera = camera_at(1.5, 1.2, 2.4);
    view_ = make_view(context_, manner.fixed_camera ? &camera : nullptr);
    insitu_effects effects;
    insitu_effects_init(&effects);
    effects.flags = INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION;
    effects.ao_samples = 3;  // as far as a tenth of the diagonal of what is drawn
    EXPECT_TRUE(works(context_, insitu_view_set_effects(context_, view_, &effects)));
    image_ = make_image(context_, 72, 56, 2);
    set_ = make_particles(context_, manner.order);
    const insitu_style style = make_style("heat", 0.0, 1.0);
    EXPECT_TRUE(works(context_, insitu_geometry_set_style(context_, set_, &style)));
    EXPECT_TRUE(works(context_, insitu_particles_set_cell(context_, set_, manner.cell)));
    position_ = insitu_array_records(INSITU_F64, 3, grains_.xyz.data(), grains_.count(), 0);
    heat_ = insitu_array_records(INSITU_F64, 1, grains_.heat.data(), grains_.count(), 0);
    radius_ = insitu_array_records(INSITU_F64, 1, grains_.radius.data(), grains_.count(), 0);
    id_ = insitu_array_records(INSITU_I64, 1, grains_.id.data(), grains_.count(), 0);
    kind_ = insitu_array_records(INSITU_I32, 1, grains_.kind.data(), grains_.count(), 0);
    for (insitu_array* array : {&position_, &heat_, &radius_, &id_, &kind_}) array->flags = INSITU_ARRAY_PERMUTABLE;
    insitu_particles_desc_init(&desc_);
    desc_.position = &position_;
    desc_.radius = &radius_;
    desc_.type = &kind_;
    desc_.attributes = attributes_;
    desc_.attribute_count = 2;
    desc_.treelet_share = manner.treelet_share;
  }
  void begin(std::uint64_t step = 0) {
    EXPECT_TRUE(works(context_, insitu_step_begin(context_, step, 0.0)));
    EXPECT_TRUE(works(context_, insitu_particles_update(context_, set_, &desc_)));
  }
  // Without items, whose numbers are other ones.
  Picture picture() {
    EXPECT_TRUE(works(context_, insitu_commit(context_)));
    EXPECT_TRUE(works(context_, insitu_render(context_, view_, image_)));
    return without_items(read_picture(context_, image_));
  }
  void end() { EXPECT_TRUE(works(context_, insitu_step_end(context_))); }
  void filter(const std::vector<insitu_filter_term>& terms) {
    EXPECT_TRUE(works(context_, set_filter(context_, set_, terms)));
  }
  void expect_bounds_of(Stage& other) {
    double bounds[4][3];
    EXPECT_TRUE(works(context_, insitu_geometry_bounds(context_, set_, bounds[0], bounds[1])));
    EXPECT_TRUE(works(other.context_, insitu_geometry_bounds(other.context_, other.set_, bounds[2], bounds[3])));
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(bounds[0][c], bounds[2][c]);
      EXPECT_EQ(bounds[1][c], bounds[3][c]);
    }
  }
  const Context& context() const { return context_; }
  insitu_geometry set() const { return set_; }

 private:
  Grains grains_;
  Context context_;
  insitu_view view_;
  insitu_image image_;
  insitu_geometry set_;
  insitu_array position_, heat_, radius_, id_, kind_;
  insitu_attribute attributes_[2] = {{"heat", &heat_}, {"id", &id_}};
  insitu_particles_desc desc_;
};

// What can be asked, and what it means.
struct Question {
  const char* name;
  std::vector<insitu_filter_term> terms;
  std::function<bool(const Grains&, std::size_t)> keep;
};

std::vector<Question> questions() {
  static const std::vector<std::int32_t> kinds = {3, 1};
  static const std::vector<std::int64_t> ids = {(std::int64_t{1} << 53) + 1, (std::int64_t{1} << 53) + 4};
  static const insitu_array kind_set = insitu_array_records(INSITU_I32, 1, kinds.data(), 2, 0);
  static const insitu_array id_set = insitu_array_records(INSITU_I64, 1, ids.data(), 2, 0);
  insitu_filter_term of_kind = filter_term(INSITU_FILTER_SET, "type");
  of_kind.set = &kind_set;
  insitu_filter_term by_id = filter_term(INSITU_FILTER_SET, "id");
  by_id.set = &id_set;
  by_id.flags = INSITU_FILTER_NOT;
  insitu_filter_term box = filter_term(INSITU_FILTER_BOX);
  for (double& x : box.lower) x = 0.2;
  for (double& x : box.upper) x = 0.9;
  insitu_filter_term plane = filter_term(INSITU_FILTER_PLANE);
  plane.plane[0] = 1.0;
  plane.plane[1] = -1.0;
  insitu_filter_term hot = range_term("heat", 0.8, infinity);
  hot.alternative = 7;
  insitu_filter_term cold_box = box;
  insitu_filter_term cold = range_term("heat", -infinity, 0.2);
  const auto in_box = [](const Grains& g, std::size_t i) {
    return std::all_of(&g.xyz[3 * i], &g.xyz[3 * i] + 3, [](double x) { return x >= 0.2 && x <= 0.9; });
  };
  return {{"range",
           {range_term("heat", 0.3, 0.6)},
           [](const Grains& g, std::size_t i) { return g.heat[i] >= 0.3 && g.heat[i] <= 0.6; }},
          {"types", {of_kind}, [](const Grains& g, std::size_t i) { return g.kind[i] == 1 || g.kind[i] == 3; }},
          {"not these ids", {by_id}, [](const Grains&, std::size_t i) { return i != 1 && i != 4; }},
          {"box", {box}, in_box},
          {"plane", {plane}, [](const Grains& g, std::size_t i) { return g.xyz[3 * i] - g.xyz[3 * i + 1] >= 0.0; }},
          {"cold within a box, or hot",
           {cold, hot, cold_box},
           [in_box](const Grains& g, std::size_t i) { return (g.heat[i] <= 0.2 && in_box(g, i)) || g.heat[i] >= 0.8; }},
          {"nothing", {range_term("heat", 2.0, 3.0)}, [](const Grains&, std::size_t) { return false; }}};
}

TEST(Filters, ShowWhatIsLeftAsIfItWereAlone) {
  const Grains all(sanitized ? 300 : 1500);
  for (const std::uint32_t order : {INSITU_ORDER_INDEX, INSITU_ORDER_PERMUTE, INSITU_ORDER_COPY}) {
    for (const double share : {0.0, 0.3}) {
      for (const bool fixed_camera : {true, false}) {
        Manner manner;
        manner.order = order;
        manner.treelet_share = share;
        manner.fixed_camera = fixed_camera;
        for (const Question& question : questions()) {
          SCOPED_TRACE(question.name);
          Stage filtered(all, manner);
          filtered.filter(question.terms);
          filtered.begin();
          const Grains left = all.left([&](std::size_t i) { return question.keep(all, i); });
          Stage alone(left, manner);
          alone.begin();
          EXPECT_TRUE(filtered.picture() == alone.picture());
          filtered.expect_bounds_of(alone);
          const insitu_stats stats = filtered.context().stats();
          EXPECT_EQ(stats.items, all.count());
          EXPECT_EQ(stats.items_skipped, 0u);
          EXPECT_EQ(stats.items_filtered, all.count() - left.count());
          filtered.end();
          alone.end();
        }
      }
    }
  }
}

// One step, many commits: the tree is built once, and each picture is that of its filter.
TEST(Filters, ChangeWithoutABuild) {
  const Grains all(800);
  for (const double share : {0.0, 0.3}) {
    Manner manner;
    manner.treelet_share = share;
    Stage stage(all, manner);
    stage.begin();
    const Picture whole = stage.picture();
    const std::uint64_t built = stage.context().stats().trees_built;
    EXPECT_EQ(built, 1u);
    for (const Question& question : questions()) {
      SCOPED_TRACE(question.name);
      stage.filter(question.terms);
      const Grains left = all.left([&](std::size_t i) { return question.keep(all, i); });
      Stage alone(left, manner);
      alone.begin();
      EXPECT_TRUE(stage.picture() == alone.picture());
      EXPECT_EQ(stage.context().stats().items_filtered, all.count() - left.count());
      alone.end();
    }
    EXPECT_TRUE(works(stage.context(), insitu_particles_set_filter(stage.context(), stage.set(), nullptr)));
    EXPECT_TRUE(stage.picture() == whole);
    const insitu_stats stats = stage.context().stats();
    EXPECT_EQ(stats.items_filtered, 0u);
    EXPECT_EQ(stats.trees_built + stats.trees_repaired + stats.trees_reused, built);
    EXPECT_EQ(stats.items, all.count());
    stage.end();
  }
}

// Kept from step to step, and in force from a commit on, not before.
TEST(Filters, LastUntilChanged) {
  const Grains all(400);
  Stage stage(all, {});
  stage.begin(0);
  const Picture whole = stage.picture();
  stage.end();
  stage.filter({range_term("heat", 0.0, 0.3)});
  stage.begin(1);
  const Picture cold = stage.picture();
  EXPECT_FALSE(cold == whole);
  stage.end();
  stage.begin(2);
  EXPECT_TRUE(stage.picture() == cold);
  stage.filter({});
  EXPECT_EQ(stage.context().stats().items_filtered > 0, true) << "not yet committed";
  EXPECT_TRUE(stage.picture() == whole);
  stage.end();
}

// Copies of the cell, and particles shown at their image within it.
TEST(Filters, GoThroughCells) {
  const Grains all(300);
  insitu_cell cell = unit_cell(INSITU_CELL_PERIODIC | INSITU_CELL_OUTLINE);
  cell.replicate[0] = 2;
  for (double& x : cell.origin) x = 0.35;
  for (const std::uint32_t wrap : {0u, std::uint32_t{INSITU_CELL_WRAP}}) {
    cell.flags = INSITU_CELL_PERIODIC | INSITU_CELL_OUTLINE | wrap;
    for (const Question& question : questions()) {
      SCOPED_TRACE(question.name);
      Manner manner;
      manner.cell = &cell;
      Stage filtered(all, manner);
      filtered.filter(question.terms);
      filtered.begin();
      Stage alone(all.left([&](std::size_t i) { return question.keep(all, i); }), manner);
      alone.begin();
      EXPECT_TRUE(filtered.picture() == alone.picture());
      filtered.end();
      alone.end();
    }
  }
}

// Bonds where both ends are left, arrows where their particle is; also when the filter changes in the same step.
TEST(Filters, TakeBondsAndArrowsAlong) {
  Data data(250);
  data.bond(0.25, false);
  const auto is_left = [&](std::size_t i) { return data.value[i] <= 0.6; };
  Data left = data;
  left.xyz.clear();
  left.value.clear();
  left.vector.clear();
  left.pairs.clear();
  std::vector<std::int32_t> number(data.count(), -1);
  for (std::size_t i = 0; i < data.count(); ++i) {
    if (!is_left(i)) continue;
    number[i] = static_cast<std::int32_t>(left.count());
    left.xyz.insert(left.xyz.end(), &data.xyz[3 * i], &data.xyz[3 * i] + 3);
    left.vector.insert(left.vector.end(), &data.vector[3 * i], &data.vector[3 * i] + 3);
    left.value.push_back(data.value[i]);
  }
  for (std::size_t p = 0; p < data.pairs.size(); p += 2) {
    const auto a = static_cast<std::size_t>(data.pairs[p]);
    const auto b = static_cast<std::size_t>(data.pairs[p + 1]);
    if (is_left(a) && is_left(b)) left.pairs.insert(left.pairs.end(), {number[a], number[b]});
  }
  ASSERT_LT(left.pairs.size(), data.pairs.size());
  for (int what = 0; what < 3; ++what) {
    Wish wish;
    wish.by_pairs = what == 0;
    wish.cutoff = what == 1 ? 0.25 : 0.0;
    wish.arrows = what == 2;
    const Picture alone = without_items(draw(left, wish));
    for (const bool changed_late : {false, true}) {
      wish.filter = {range_term("value", -infinity, 0.6)};
      wish.filter_late = changed_late;
      std::string warnings;
      EXPECT_TRUE(without_items(draw(data, wish, &warnings)) == alone) << what << (changed_late ? ", late" : "");
      EXPECT_EQ(warnings, "") << "what a filter leaves out is not bad";
    }
  }
}

// Radii and colour ranges that the library chooses are those of all particles: what is left keeps its look.
TEST(Filters, KeepAutomaticRadiiAndColours) {
  Grains all(300);
  const auto draw_with = [&](const std::vector<insitu_filter_term>& terms, bool automatic, double* radius) {
    const Context context(1);
    const insitu_camera camera = camera_at(1.5, 1.2, 2.4);
    const insitu_view view = make_view(context, &camera, 0);
    const insitu_image image = make_image(context, 64, 48, 1);
    const insitu_geometry set = make_particles(context);
    insitu_style style = make_style("heat", *std::min_element(all.heat.begin(), all.heat.end()),
                                    *std::max_element(all.heat.begin(), all.heat.end()));
    if (automatic) style.range_mode = INSITU_RANGE_AUTO;
    EXPECT_TRUE(works(context, insitu_geometry_set_style(context, set, &style)));
    EXPECT_TRUE(works(context, set_filter(context, set, terms)));
    const insitu_array position = insitu_array_records(INSITU_F64, 3, all.xyz.data(), all.count(), 0);
    const insitu_array heat = insitu_array_records(INSITU_F64, 1, all.heat.data(), all.count(), 0);
    const insitu_attribute attribute = {"heat", &heat};
    insitu_particles_desc desc;
    insitu_particles_desc_init(&desc);
    desc.position = &position;
    desc.attributes = &attribute;
    desc.attribute_count = 1;
    if (!automatic) desc.radius_default = *radius;
    EXPECT_TRUE(works(context, insitu_step_begin(context, 0, 0.0)));
    EXPECT_TRUE(works(context, insitu_particles_update(context, set, &desc)));
    EXPECT_TRUE(works(context, insitu_commit(context)));
    EXPECT_TRUE(works(context, insitu_render(context, view, image)));
    const Picture picture = read_picture(context, image);
    double lower[3];
    double upper[3];
    EXPECT_TRUE(works(context, insitu_geometry_bounds(context, set, lower, upper)));
    if (automatic) *radius = all.xyz[0] - lower[0];  // with the first particle alone
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    return picture;
  };
  // The radius that the library chooses for all, seen from the bounds of one.
  double radius = 0.0;
  insitu_filter_term first = filter_term(INSITU_FILTER_BOX);
  for (std::size_t c = 0; c < 3; ++c) first.lower[c] = first.upper[c] = all.xyz[c];
  draw_with({first}, true, &radius);
  EXPECT_NEAR(radius, 0.5 / std::cbrt(300.0), 0.1 / std::cbrt(300.0));
  // The bounds round: a radius alike to its last bits covers the same pixels here.
  double unused = 0.0;
  const std::vector<insitu_filter_term> some = {range_term("heat", 0.4, 0.6)};
  EXPECT_EQ(clearly_differing(draw_with(some, true, &unused), draw_with(some, false, &radius)), 0u);
}

}  // namespace
}  // namespace insitu::testing
