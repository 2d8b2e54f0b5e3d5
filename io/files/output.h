// io/files/output.h – where results go: files that are complete or not there and one command's at a time, standard
// output that is checked.
#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace dea {

/// Throws UsageError when outputs coincide with each other or with an input, or more than one goes to standard output;
/// WriteError when the folder of one does not exist. Before any work, so that nothing is lost.
struct NamedPath {
  std::string option;  ///< "-o", "--json"; "the model" for inputs
  std::string path;
  bool folder = false;  ///< a folder, made if it is missing
};
void check_outputs(const std::vector<NamedPath>& inputs, const std::vector<NamedPath>& outputs);

/// Writes a whole text: "-" to standard output; a file by way of a temporary one beside it. Throws WriteError.
void write_text(const std::string& path, const std::string& text);
/// The same of a text that comes in pieces: `write` calls `put` with each. What `write` throws leaves nothing behind.
using PutPiece = std::function<void(const std::string& piece)>;
void write_pieces(const std::string& path, const std::function<void(const PutPiece& put)>& write);

/// The same by whoever is given an open file: another program. A device or a pipe is refused: it is no place to go back
/// in. Throws WriteError, and what `write` throws.
void write_open_file(const std::string& path, const std::function<void(int file)>& write);

/// The same by a library that opens files itself: the name of an empty one, to be closed when `write` ends.
void write_named_file(const std::string& path, const std::function<void(const std::string& name)>& write);

/// A folder of new files: it is there with all of them, or as it was before. `write` calls `put` with each. A folder
/// that is there is replaced if `old(name)` holds for all of its files. Throws WriteError: it holds others.
using PutFile = std::function<void(const std::string& name, const std::string& text)>;
void write_folder(const std::string& path, const std::function<bool(const std::string& name)>& old,
                  const std::function<void(const PutFile& put)>& write);

/// A new file in `folder`, opened to write and read, under a short name of its own: the result's may already be as long
/// as is allowed. -1 and errno: there is none.
int create_temporary(const std::filesystem::path& folder, std::filesystem::path& name);

/// A file or folder that is taken away at the end, if it has not got another name by then.
struct Temporary {
  const std::string path;
  explicit Temporary(const std::filesystem::path& name);
  ~Temporary();
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
};
/// Takes away all Temporary there are. For signal handlers, before they end the program.
void remove_unfinished();

/// For as long as it lives no other process holds the same output. It is held by an advisory lock on a small file
/// beside it, ".NAME.lock", which is taken away at the end. A process that was killed holds nothing: the lock ends with
/// it, and a file that it left behind is used again.
struct HeldOutput {
  const int file;
  std::optional<Temporary> name;
  HeldOutput(int locked, const std::filesystem::path& lock) : file(locked), name(lock) {}
  ~HeldOutput();
};
using HeldOutputs = std::deque<HeldOutput>;

/// The outputs, after check_outputs. Those of an empty path are not wanted. Standard output and devices are passed
/// over, and file systems without locks. Throws WriteError: another process holds one of them, or its folder cannot be
/// written to.
[[nodiscard]] HeldOutputs claim_outputs(const std::vector<NamedPath>& inputs, std::vector<NamedPath> outputs);

/// Bytes that wait on disk until what they are part of is complete: a file without a name, beside the result it is for
/// or, where there is no room for it (no folder to write to, a device, standard output), among the system's temporary
/// files. It goes with the process, killed or not.
class Spool {
 public:
  /// `path`: of the result, for its place and its faults. Throws WriteError.
  explicit Spool(std::string path);
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();
  /// At the end. Throws WriteError.
  void add(const std::string& bytes);
  std::uint64_t size() const { return size_; }
  /// Gives `count` bytes from `begin` on to `put`, in pieces. Throws WriteError: they are not there any more.
  void read(std::uint64_t begin, std::uint64_t count, const PutPiece& put) const;

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// Throws WriteError: what the system says of `error`, errno.
[[noreturn]] void cannot_write(const std::string& path, int error);
[[noreturn]] void cannot_write(const std::string& path, const std::error_code& error);

/// Text for people, made printable (names.h), on standard output. Throws WriteError when that took not all of it.
void print(const std::string& text);

/// One line on standard error, whatever names it quotes (message_line).
void log(const std::string& line);

/// "hip.feb" -> "hip_dea.xplt", in the same folder, as FEBio does.
std::string default_output(const std::string& model, const std::string& extension = ".xplt");

/// Does it stand between a folder and a name in it?
bool is_separator(char c);

/// "results/" is the folder "results".
std::string without_slash(const std::string& folder);

/// ".feb" of "hip.FEB": in small letters, as names are compared.
std::string extension_of(const std::string& path);
/// "--report hip: found no ending, expected a name that ends in .html or .htm: hip.html"
std::string wrong_ending(const std::string& option, const std::string& path, const char* endings, const char* first);

/// Seconds of a clock that never goes back.
double seconds();

}  // namespace dea
