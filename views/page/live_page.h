// views/page/live_page.h – one file that has the program for a browser, a joint, and what it is solved with.
#pragma once
#include <string>
#include <vector>

namespace dea {

/// A file that the page opens by itself, under a name without a folder.
struct PageFile {
  std::string name;
  std::string path;
  std::string kind;  ///< model, part (of the model), settings, table
};

/// `program`: the path of dea.html; its sample gives way to `files`, the model first. `words`: settings as `dea run`
/// has them, with the names that the files have in the page. Throws InputError: a file that cannot be read, a page that
/// is not dea.html of this version.
std::string live_page(const std::string& program, const std::vector<PageFile>& files,
                      const std::vector<std::string>& words);

}  // namespace dea
