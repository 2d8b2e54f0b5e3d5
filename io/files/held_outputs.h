// io/files/held_outputs.h – output files that one command at a time works for.
#pragma once
#include <memory>
#include <vector>

#include "io/files/output.h"

namespace dea {

/// For as long as it lives no other process holds the same outputs. Each is held by an advisory lock on a small file
/// beside it, ".NAME.lock", which is taken away at the end. A process that was killed holds nothing: the lock ends with
/// it, and a file that it left behind is used again.
class HeldOutputs {
 public:
  HeldOutputs() = default;
  HeldOutputs(HeldOutputs&& other) noexcept = default;
  HeldOutputs& operator=(HeldOutputs&&) = delete;
  ~HeldOutputs();

 private:
  friend HeldOutputs claim_outputs(const std::vector<NamedPath>& inputs, std::vector<NamedPath> outputs);
  struct Held {
    int file;
    std::unique_ptr<Temporary> name;
  };
  std::vector<Held> held_;
};

/// The outputs, after check_outputs. Those of an empty path are not wanted. Standard output and devices are passed over,
/// and file systems without locks. Throws WriteError: another process holds one of them, or its folder cannot be
/// written to.
[[nodiscard]] HeldOutputs claim_outputs(const std::vector<NamedPath>& inputs, std::vector<NamedPath> outputs);

}  // namespace dea
