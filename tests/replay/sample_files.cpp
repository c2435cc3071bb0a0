#include "sample_files.h"

#include <cmath>
#include <numeric>

#include "binary_writer.h"

namespace replay::test {
namespace {

std::vector<double> counted(std::size_t count, double factor) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = factor * static_cast<double>(i);
  return values;
}

// A block of Gadget's, with its name before it in format 2.
class GadgetFile {
 public:
  explicit GadgetFile(const GadgetSample& what) : what_(what), file_(what.order) {}

  void block(std::string_view tag, const std::vector<double>& values, bool whole = false) {
    BinaryWriter content(what_.order);
    for (const double value : values) {
      if (whole) {
        what_.wide ? content.put(static_cast<std::uint64_t>(value)) : content.put(static_cast<std::uint32_t>(value));
      } else {
        what_.wide ? content.put(value) : content.put(static_cast<float>(value));
      }
    }
    block(tag, content);
  }
  void block(std::string_view tag, const BinaryWriter& content) {
    if (what_.tagged) {
      const auto next = static_cast<std::uint32_t>(content.size() + 8);
      file_.record(BinaryWriter(what_.order).put_text(tag).put(next));
    }
    file_.record(content);
  }
  const std::string& text() const { return file_.text(); }

 private:
  GadgetSample what_;
  BinaryWriter file_;
};

}  // namespace

std::string gadget_sample(const GadgetSample& what) {
  const std::vector<std::uint32_t> count = {2, 1, 0, 0, 2, 0};
  BinaryWriter header(what.order);
  header.put_all(count).put_all(std::vector<double>{0, 0.5, 0, 0, 0, 0});
  header.put(0.25).put(3.0).put(0).put(0);  // time, redshift, star formation, feedback
  for (const std::uint32_t n : count) header.put(n * what.in_all);
  header.put(0).put(what.files).put(50.0).put(0.3).put(0.7).put(0.7);  // cooling, files, box, cosmology
  header.fill(256 - header.size());
  GadgetFile file(what);
  file.block("HEAD", header);
  file.block("POS ", counted(15, 1));
  file.block("VEL ", counted(15, 10));
  std::vector<double> ids(5);
  std::iota(ids.begin(), ids.end(), what.first_id);
  if (what.wide) ids.back() += std::ldexp(1.0, 40);
  file.block("ID  ", ids, true);
  file.block("MASS", {1, 2, 4, 5});
  file.block("U   ", {100, 200});
  file.block("RHO ", {1, 8});
  file.block("HSML", {7, 8});
  return file.text();
}

std::string tipsy_sample(const TipsySample& what) {
  BinaryWriter file(what.order);
  file.put(0.5).put(4).put(3).put(1).put(2).put(1);
  if (what.padding) file.put(0);
  const int behind[4] = {5, 2, 2, 4};  // gas, dark, dark, star
  double next = 0;
  for (int k = 0; k < 4; ++k) {
    const auto scalar = [&](double value, bool wide) { wide ? file.put(value) : file.put(static_cast<float>(value)); };
    scalar(k + 1.0, false);
    for (int c = 0; c < 3; ++c) scalar(next + c, what.wide_positions);
    for (int c = 0; c < 3; ++c) scalar(-(next + c), what.wide_velocities);
    next += 3;
    for (int v = 0; v < behind[k]; ++v) scalar(k + 1.0 + 0.25 * (v + 1), false);
  }
  return file.text();
}

std::string dcd_sample(const DcdSample& what) {
  constexpr int atoms = 4;
  BinaryWriter file(what.order);
  const auto record = [&](const BinaryWriter& content) {
    what.wide_markers ? file.record<std::uint64_t>(content) : file.record(content);
  };
  BinaryWriter header(what.order);
  header.put_text("CORD").put(3).put(10).put(5).fill(5 * 4).put(what.fixed);
  if (what.charmm) {
    header.put(2.0f).put(what.cell ? 1 : 0).put(what.fourth ? 1 : 0).fill(7 * 4).put(24);
  } else {
    header.put(2.0).fill(9 * 4);
  }
  record(header);
  record(BinaryWriter(what.order).put(1).put_text(std::string(80, ' ')));
  record(BinaryWriter(what.order).put(atoms));
  if (what.fixed > 0) {
    BinaryWriter free(what.order);
    for (int atom = what.fixed; atom < atoms; ++atom) free.put(atom + 1);
    record(free);
  }
  for (int step = 0; step < 3; ++step) {
    // A, cosine of gamma, B, cosine of beta, cosine of alpha, C.
    if (what.charmm && what.cell) record(BinaryWriter(what.order).put_all(std::vector<double>{4, 0.5, 2, 0, 0, 8}));
    for (const int factor : {1, 10, 100}) {
      BinaryWriter axis(what.order);
      for (int atom = step > 0 ? what.fixed : 0; atom < atoms; ++atom)
        axis.put(static_cast<float>(atom * factor + step));
      record(axis);
    }
    if (what.charmm && what.fourth) record(BinaryWriter(what.order).fill(4 * atoms));
  }
  return file.text();
}

}  // namespace replay::test
