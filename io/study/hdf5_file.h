// io/study/hdf5_file.h – HDF5 as far as the columns of a study need it: variables over dimensions, in the layout of
// netCDF-4 (dimensions are HDF5's dimension scales), so that netCDF's readers open it, too. The one place that knows
// HDF5.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace dea {

/// An object of HDF5; closed with the last that holds it.
using Hdf5Object = std::shared_ptr<const std::int64_t>;

/// A dimension of a file or of a group in it.
struct Hdf5Dimension {
  std::string name;
  std::size_t size = 0;
  Hdf5Object scale;
};

enum class Hdf5Type { Double, Float, Integer, Word, Text };  ///< Word: one byte, the number of a word

/// Numbers over dimensions, written a block of the first dimension at a time. What is not written is NaN, 0 or empty.
struct Hdf5Variable {
  Hdf5Type type = Hdf5Type::Double;
  std::vector<std::size_t> sizes;
  Hdf5Object dataset;
};

/// A new file at the place of `path`. Faults of it: WriteError, with the path.
class Hdf5File {
 public:
  /// `shown`: as the user calls it.
  Hdf5File(const std::string& path, std::string shown);
  const Hdf5Object& root() const { return root_; }
  Hdf5Object group(const Hdf5Object& in, const std::string& name) const;

  /// With a variable of the same name, its labels.
  Hdf5Dimension dimension(const Hdf5Object& in, const std::string& name, const std::vector<std::int64_t>& labels) const;
  Hdf5Dimension dimension(const Hdf5Object& in, const std::string& name, const std::vector<std::string>& labels) const;

  /// `block`: how many of the first dimension are written at a time, and stand together in the file.
  Hdf5Variable variable(const Hdf5Object& in, const std::string& name, Hdf5Type type,
                        const std::vector<Hdf5Dimension>& dimensions, std::size_t block) const;
  /// All values of `count` of the first dimension from `begin` on, the last dimension the fastest.
  void write(const Hdf5Variable& to, std::size_t begin, std::size_t count, const std::vector<double>& values) const;
  void write(const Hdf5Variable& to, std::size_t begin, std::size_t count, const std::vector<float>& values) const;
  void write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
             const std::vector<std::int64_t>& values) const;
  void write(const Hdf5Variable& to, std::size_t begin, std::size_t count,
             const std::vector<std::string>& values) const;

  void attribute(const Hdf5Object& of, const std::string& name, const std::string& text) const;
  /// "flag_values" and "flag_meanings" as the CF conventions have them: the words that the numbers 0, 1, ... stand for.
  void words(const Hdf5Variable& of, const std::vector<std::string>& words) const;
  /// Writes what is not yet on disk. Nothing may be open but this.
  void close();

 private:
  Hdf5Object made(std::int64_t id, int (*close)(std::int64_t)) const;
  void check(int result) const;
  [[noreturn]] void fail() const;
  template <class Label>
  Hdf5Dimension labelled(const Hdf5Object& in, const std::string& name, Hdf5Type type,
                         const std::vector<Label>& labels) const;
  void write_block(const Hdf5Variable& to, std::size_t begin, std::size_t count, std::int64_t type,
                   const void* values) const;

  std::string shown_;
  Hdf5Object root_;
};

}  // namespace dea
