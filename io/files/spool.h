// io/files/spool.h – bytes that wait on disk until what they are part of is complete.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

namespace dea {

/// A file without a name, beside the result it is for or, where there is no room for it (no folder to write to, a
/// device, standard output), among the system's temporary files. It goes with the process, killed or not.
class Spool {
 public:
  /// `path`: of the result, for its place and its faults. Throws WriteError.
  explicit Spool(std::string path);
  Spool(Spool&& other) noexcept;
  Spool& operator=(Spool&&) = delete;
  ~Spool();
  /// At the end. Throws WriteError.
  void add(const std::string& bytes);
  std::uint64_t size() const { return size_; }
  /// Gives `count` bytes from `begin` on to `put`, in pieces. Throws WriteError: they are not there any more.
  void read(std::uint64_t begin, std::uint64_t count, const std::function<void(const std::string& piece)>& put) const;

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace dea
