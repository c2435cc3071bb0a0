#include "hdf5_file.h"

#include <hdf5.h>

#include <utility>

#include "byte_reader.h"
#include "input_error.h"

namespace replay {
namespace {

constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";

// An identifier of the library, closed at the end of its scope.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  Close close_;
};

// The reason that the library noted first, deepest inside.
std::string reason() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
        auto& first = *static_cast<std::string*>(out);
        if (first.empty() && error->desc != nullptr) first = error->desc;
        return 0;
      },
      &text);
  return text.empty() ? "no reason is given" : text;
}

// For a type that holds_numbers(); smaller ones widen without loss.
Scalars vector_for(hid_t type) {
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) == H5T_FLOAT) {
    if (bytes <= 4) return std::vector<float>();
    return std::vector<double>();
  }
  const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
  if (bytes <= 4 && is_signed) return std::vector<std::int32_t>();
  if (bytes <= 4) return std::vector<std::uint32_t>();
  if (is_signed) return std::vector<std::int64_t>();
  return std::vector<std::uint64_t>();
}

bool holds_numbers(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return (kind == H5T_FLOAT || kind == H5T_INTEGER) && H5Tget_size(type) <= 8;
}

hid_t memory_type(const std::vector<double>&) { return H5T_NATIVE_DOUBLE; }
hid_t memory_type(const std::vector<float>&) { return H5T_NATIVE_FLOAT; }
hid_t memory_type(const std::vector<std::int32_t>&) { return H5T_NATIVE_INT32; }
hid_t memory_type(const std::vector<std::uint32_t>&) { return H5T_NATIVE_UINT32; }
hid_t memory_type(const std::vector<std::int64_t>&) { return H5T_NATIVE_INT64; }
hid_t memory_type(const std::vector<std::uint64_t>&) { return H5T_NATIVE_UINT64; }

}  // namespace

Hdf5File::Hdf5File(std::string path) : path_(std::move(path)) {
  static_assert(sizeof(hid_t) <= sizeof file_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to print
  ByteReader bytes(path_);
  bytes_ = bytes.size();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (bytes.is_compressed()) {
    bytes.numbers(bytes_, "the rest of the file", unpacked_);
    H5Pset_fapl_core(access, std::size_t{1} << 20, 0);
    H5Pset_file_image(access, unpacked_.data(), unpacked_.size());
  }
  // An image in memory must not bear the name of a file that there is.
  const std::string name = bytes.is_compressed() ? path_ + "/unpacked" : path_;
  file_ = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access);
  if (file_ < 0) fail_with_reason("cannot be read as HDF5");
  unpacked_ = std::vector<char>();  // the library has a copy
}

Hdf5File::~Hdf5File() {
  if (file_ >= 0) H5Fclose(file_);
}

bool Hdf5File::has(const std::string& name) const {
  return H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0 && H5Oexists_by_name(file_, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> Hdf5File::members(const std::string& group, bool groups) const {
  const Handle id(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!id.good()) fail_with_reason("the group \"" + group + "\" cannot be opened");
  std::vector<std::string> names;
  const herr_t result = H5Literate(
      id, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
        static_cast<std::vector<std::string>*>(out)->emplace_back(name);
        return 0;
      },
      &names);
  if (result < 0) fail_with_reason("the content of the group \"" + group + "\" cannot be read");
  std::erase_if(names, [&](const std::string& name) {
    if (H5Oexists_by_name(id, name.c_str(), H5P_DEFAULT) <= 0) return true;
    const Handle object(H5Oopen(id, name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.good()) fail_with_reason("\"" + group + "/" + name + "\" cannot be opened");
    return H5Iget_type(object) != (groups ? H5I_GROUP : H5I_DATASET);
  });
  return names;
}

std::vector<std::string> Hdf5File::arrays_in(const std::string& group) const { return members(group, false); }
std::vector<std::string> Hdf5File::groups_in(const std::string& group) const { return members(group, true); }

Hdf5File::Array Hdf5File::describe(const std::string& name) const {
  const Handle array(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!array.good()) fail_with_reason("the array \"" + name + "\" cannot be opened");
  const Handle space(H5Dget_space(array), H5Sclose);
  const Handle type(H5Dget_type(array), H5Tclose);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions < 0) fail_with_reason("the array \"" + name + "\" has no extent");
  std::vector<hsize_t> extent(static_cast<std::size_t>(dimensions));
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  Array out;
  out.extent.assign(extent.begin(), extent.end());
  out.numbers = holds_numbers(type);
  return out;
}

Scalars Hdf5File::read(const std::string& name) const {
  const Handle array(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!array.good()) fail_with_reason("the array \"" + name + "\" cannot be opened");
  const Handle space(H5Dget_space(array), H5Sclose);
  const Handle type(H5Dget_type(array), H5Tclose);
  const Handle creation(H5Dget_create_plist(array), H5Pclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 0 || !holds_numbers(type)) fail("the array \"" + name + "\" holds no numbers");
  // Deflate, the best of the filters in use, packs no more than 1032 bytes into one. A virtual array has its values in
  // other files.
  constexpr std::uint64_t best_compression = 1032;
  const auto values = static_cast<std::uint64_t>(count);
  const bool in_this_file = H5Pget_layout(creation) != H5D_VIRTUAL;
  if (in_this_file && values / best_compression > bytes_) {
    fail("the array \"" + name + "\" has " + std::to_string(values) +
         " values by its extent, more than the file can hold");
  }
  Scalars scalars = vector_for(type);
  std::visit(
      [&](auto& out) {
        out.resize(static_cast<std::size_t>(values));
        if (values > 0 && H5Dread(array, memory_type(out), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()) < 0) {
          fail_with_reason("the array \"" + name + "\" cannot be read");
        }
      },
      scalars);
  return scalars;
}

std::vector<double> Hdf5File::attribute(const std::string& object, const std::string& name) const {
  if (!has(object) || H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return {};
  const Handle id(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!id.good()) fail_with_reason("the attribute \"" + name + "\" of \"" + object + "\" cannot be opened");
  const Handle space(H5Aget_space(id), H5Sclose);
  const Handle type(H5Aget_type(id), H5Tclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  constexpr hssize_t longest = 1 << 16;  // the format's own limit for attributes of old files is 64 KiB
  if (count < 0 || count > longest || !holds_numbers(type)) return {};
  std::vector<double> values(static_cast<std::size_t>(count));
  if (count > 0 && H5Aread(id, H5T_NATIVE_DOUBLE, values.data()) < 0) {
    fail_with_reason("the attribute \"" + name + "\" of \"" + object + "\" cannot be read");
  }
  return values;
}

void Hdf5File::fail(const std::string& what) const { throw InputError(path_, 0, what); }
void Hdf5File::fail_with_reason(const std::string& what) const { fail(what + " (" + reason() + ")"); }

bool is_hdf5(std::string_view first_bytes) { return first_bytes.substr(0, signature.size()) == signature; }

}  // namespace replay
