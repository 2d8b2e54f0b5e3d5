#include "io/study/hdf5_file.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "src/base/error.h"
#include "src/base/numbers.h"

/// HDF5 would load filters that environment variables name. dea loads nothing.
extern "C" void* __wrap_dlopen(const char*, int) { return nullptr; }

namespace dea {

namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "Hdf5Object holds HDF5's numbers");

constexpr unsigned kDeflate = 1;  ///< more takes three times as long and gains some per cent
constexpr unsigned kKeepOrder = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;  ///< netCDF-4 wants it

hid_t text_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/// In the file; to be closed.
hid_t type_of(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::Double:
      return H5Tcopy(H5T_IEEE_F64LE);
    case Hdf5Type::Float:
      return H5Tcopy(H5T_IEEE_F32LE);
    case Hdf5Type::Integer:
      return H5Tcopy(H5T_STD_I64LE);
    case Hdf5Type::Word:
      return H5Tcopy(H5T_STD_I8LE);
    case Hdf5Type::Text:
      return text_type();
  }
  return H5I_INVALID_HID;
}

/// The innermost fault of the last call.
herr_t innermost(unsigned n, const H5E_error2_t* error, void* words) {
  if (n == 0) *static_cast<std::string*>(words) = error->desc;
  return 0;
}

/// "No space left on device" of "file write failed: ..., error message = 'No space left on device', ...".
std::string plain(const std::string& words) {
  const std::string before = "error message = '";
  const std::size_t begin = words.find(before), from = begin + before.size();
  return begin == std::string::npos ? words : words.substr(from, words.find('\'', from) - from);
}

}  // namespace

Hdf5File::Hdf5File(const std::string& path, std::string shown) : shown_(std::move(shown)) {
  H5dont_atexit();  // after a full disk it would write what it still holds, and end in a fault of its own
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // faults are thrown, not printed
  const Hdf5Object creation = made(H5Pcreate(H5P_FILE_CREATE), &H5Pclose);
  check(H5Pset_link_creation_order(*creation, kKeepOrder));
  check(H5Pset_attr_creation_order(*creation, kKeepOrder));
  check(H5Pset_obj_track_times(*creation, false));  // the same study gives the same bytes
  root_ = made(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, *creation, H5P_DEFAULT), &H5Fclose);
}

void Hdf5File::close() {
  check(H5Fflush(*root_, H5F_SCOPE_GLOBAL));
  root_.reset();
}

void Hdf5File::fail() const {
  std::string words;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, &innermost, &words);
  throw WriteError(fmt::format("{}: {}", shown_, words.empty() ? "could not be written" : plain(words)));
}

void Hdf5File::check(int result) const {
  if (result < 0) fail();
}

Hdf5Object Hdf5File::made(std::int64_t id, int (*close)(std::int64_t)) const {
  if (id < 0) fail();
  return {new std::int64_t(id), [close](const std::int64_t* held) {
            close(*held);
            delete held;
          }};
}

Hdf5Object Hdf5File::group(const Hdf5Object& in, const std::string& name) const {
  const Hdf5Object creation = made(H5Pcreate(H5P_GROUP_CREATE), &H5Pclose);
  check(H5Pset_link_creation_order(*creation, kKeepOrder));
  check(H5Pset_attr_creation_order(*creation, kKeepOrder));
  check(H5Pset_obj_track_times(*creation, false));
  return made(H5Gcreate2(*in, name.c_str(), H5P_DEFAULT, *creation, H5P_DEFAULT), &H5Gclose);
}

Hdf5Variable Hdf5File::variable(const Hdf5Object& in, const std::string& name, Hdf5Type type,
                                const std::vector<Hdf5Dimension>& dimensions, std::size_t block) const {
  Hdf5Variable v{type, {}, {}};
  std::vector<hsize_t> sizes, chunk;
  for (const Hdf5Dimension& d : dimensions) {
    v.sizes.push_back(d.size);
    sizes.push_back(d.size);
    chunk.push_back(std::max<hsize_t>(1, d.size));
  }
  chunk.front() = std::clamp<hsize_t>(block, 1, chunk.front());
  const Hdf5Object creation = made(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
  check(H5Pset_obj_track_times(*creation, false));
  check(H5Pset_attr_creation_order(*creation, kKeepOrder));
  check(H5Pset_chunk(*creation, static_cast<int>(chunk.size()), chunk.data()));
  check(H5Pset_shuffle(*creation));
  check(H5Pset_deflate(*creation, kDeflate));
  const double none = kNaN;
  if (type == Hdf5Type::Double || type == Hdf5Type::Float)
    check(H5Pset_fill_value(*creation, H5T_NATIVE_DOUBLE, &none));
  const Hdf5Object file_type = made(type_of(type), &H5Tclose);
  const Hdf5Object space = made(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), &H5Sclose);
  v.dataset = made(H5Dcreate2(*in, name.c_str(), *file_type, *space, H5P_DEFAULT, *creation, H5P_DEFAULT), &H5Dclose);
  for (std::size_t i = 0; i < dimensions.size(); ++i)
    if (dimensions[i].scale) check(H5DSattach_scale(*v.dataset, *dimensions[i].scale, static_cast<unsigned>(i)));
  return v;
}

template <class Label>
Hdf5Dimension Hdf5File::labelled(const Hdf5Object& in, const std::string& name, Hdf5Type type,
                                 const std::vector<Label>& labels) const {
  const Hdf5Variable scale = variable(in, name, type, {{name, labels.size(), nullptr}}, labels.size());
  check(H5DSset_scale(*scale.dataset, name.c_str()));
  write(scale, 0, labels.size(), labels);
  return {name, labels.size(), scale.dataset};
}

Hdf5Dimension Hdf5File::dimension(const Hdf5Object& in, const std::string& name,
                                  const std::vector<std::int64_t>& labels) const {
  return labelled(in, name, Hdf5Type::Integer, labels);
}

Hdf5Dimension Hdf5File::dimension(const Hdf5Object& in, const std::string& name,
                                  const std::vector<std::string>& labels) const {
  return labelled(in, name, Hdf5Type::Text, labels);
}

void Hdf5File::write_block(const Hdf5Variable& to, std::size_t begin, std::size_t count, std::int64_t type,
                           const void* values) const {
  std::vector<hsize_t> from(to.sizes.size(), 0), size(to.sizes.begin(), to.sizes.end());
  from.front() = begin;
  size.front() = count;
  if (std::find(size.begin(), size.end(), 0) != size.end()) return;
  const int rank = static_cast<int>(size.size());
  const Hdf5Object memory = made(H5Screate_simple(rank, size.data(), nullptr), &H5Sclose);
  const Hdf5Object file = made(H5Dget_space(*to.dataset), &H5Sclose);
  check(H5Sselect_hyperslab(*file, H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr));
  check(H5Dwrite(*to.dataset, type, *memory, *file, H5P_DEFAULT, values));
}

void Hdf5File::write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
                     const std::vector<double>& values) const {
  write_block(to, begin, count, H5T_NATIVE_DOUBLE, values.data());
}

void Hdf5File::write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
                     const std::vector<float>& values) const {
  write_block(to, begin, count, H5T_NATIVE_FLOAT, values.data());
}

void Hdf5File::write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
                     const std::vector<std::int64_t>& values) const {
  write_block(to, begin, count, H5T_NATIVE_INT64, values.data());
}

void Hdf5File::write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
                     const std::vector<std::string>& values) const {
  std::vector<const char*> texts;
  for (const std::string& text : values) texts.push_back(text.empty() ? nullptr : text.c_str());
  const Hdf5Object type = made(text_type(), &H5Tclose);
  write_block(to, begin, count, *type, texts.data());
}

void Hdf5File::attribute(const Hdf5Object& of, const std::string& name, const std::string& text) const {
  const Hdf5Object type = made(H5Tcopy(H5T_C_S1), &H5Tclose), space = made(H5Screate(H5S_SCALAR), &H5Sclose);
  check(H5Tset_size(*type, std::max<std::size_t>(1, text.size())));
  check(H5Tset_cset(*type, H5T_CSET_UTF8));
  check(H5Tset_strpad(*type, H5T_STR_NULLPAD));
  const Hdf5Object held = made(H5Acreate2(*of, name.c_str(), *type, *space, H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  check(H5Awrite(*held, *type, text.c_str()));
}

void Hdf5File::words(const Hdf5Variable& of, const std::vector<std::string>& words) const {
  std::vector<signed char> values(words.size());
  std::iota(values.begin(), values.end(), static_cast<signed char>(0));
  const hsize_t size = values.size();
  const Hdf5Object space = made(H5Screate_simple(1, &size, nullptr), &H5Sclose);
  const Hdf5Object held =
      made(H5Acreate2(*of.dataset, "flag_values", H5T_STD_I8LE, *space, H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  check(H5Awrite(*held, H5T_NATIVE_SCHAR, values.data()));
  attribute(of.dataset, "flag_meanings", fmt::format("{}", fmt::join(words, " ")));
}

}  // namespace dea
