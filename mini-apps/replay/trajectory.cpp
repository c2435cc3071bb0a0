// Positions from one file for the particles of another: topologies such as PDB files have names and elements and one
// step, trajectories such as DCD files have steps and nothing but positions.
#include <filesystem>
#include <utility>

#include "input_error.h"
#include "reader.h"

namespace replay {
namespace {

// Files whose particles may stand in any order, which the numbers of the particles tell; in others the order counts.
bool is_ordered_by_id(Format format) {
  return format == Format::lammps_data || format == Format::lammps_dump || format == Format::cif;
}

class TrajectoryReader : public FrameReader {
 public:
  TrajectoryReader(const std::string& path, const ReadOptions& options) : path_(path), paths_(options.trajectories) {
    ReadOptions of_file = options;
    of_file.trajectories.clear();
    if (!of_file.format) of_file.format = detect_format(path);
    open_reader(path, of_file)->next(particles_);
    if (is_ordered_by_id(*of_file.format)) sort_by(particles_, "id");
    // Of the step that the file shows, and of no other.
    for (const char* name : {"velocity", "speed", "acceleration", "force"}) particles_.remove(name);
  }

  bool next(Frame& frame) override {
    while (true) {
      if (!reader_) {
        if (opened_ == paths_.size()) return false;
        ReadOptions options;
        options.format = detect_format(paths_[opened_]);
        by_id_ = is_ordered_by_id(*options.format);
        reader_ = open_reader(paths_[opened_++], options);
      }
      if (reader_->next(frame)) break;
      reader_.reset();
    }
    if (frame.count() != particles_.count()) {
      throw InputError(paths_[opened_ - 1], 0,
                       "has " + std::to_string(frame.count()) + " particles in a step, expected " +
                           std::to_string(particles_.count()) + " as " +
                           replay::quoted(std::filesystem::path(path_).filename().string()) + " has");
    }
    if (by_id_) sort_by(frame, "id");
    for (const Attribute& attribute : particles_.attributes) {
      // What a particle is says the file; what changes says the trajectory.
      const bool is_kind = attribute.name == "element" || attribute.name == "type";
      if (is_kind) frame.remove(attribute.name);
      if (!frame.find(attribute.name)) frame.attributes.push_back(attribute);
    }
    if (!frame.box.known) frame.box = particles_.box;
    return true;
  }

  std::string remark() const override {
    return std::to_string(paths_.size()) + (paths_.size() == 1 ? " trajectory" : " trajectories");
  }

 private:
  std::string path_;
  std::vector<std::string> paths_;
  Frame particles_;
  std::unique_ptr<FrameReader> reader_;
  std::size_t opened_ = 0;
  bool by_id_ = false;
};

}  // namespace

std::unique_ptr<FrameReader> open_trajectories(const std::string& path, const ReadOptions& options) {
  return std::make_unique<TrajectoryReader>(path, options);
}

}  // namespace replay
