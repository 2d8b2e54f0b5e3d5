// views/page/write_page.h – results as one HTML file that needs nothing else, no network either.
#pragma once
#include <string>

#include "io/files/output.h"
#include "views/page/page_data.h"

namespace dea {

/// The page: scripts, styles and data inside. No name or text of `data` is taken for markup. UTF-8; bytes that are not
/// become U+FFFD. The same data give the same bytes.
std::string page_html(const PageData& data);

/// The page of a run whose plot file `output` has been written. `model_path`: gives it its title. `words`: the command;
/// `files`: those in it, of which only the names are shown. Throws InputError, WriteError.
void write_run_page(const std::string& path, const Recognition& recognition, const Analysis& analysis, XpltFile&& xplt,
                    const std::string& model_path, const std::string& output, const std::vector<std::string>& words,
                    const std::vector<NamedPath>& files);

/// Empty: no page is wanted. `option`: "--report" or "<report>". Throws UsageError.
void require_page_name(const std::string& option, const std::string& path);

}  // namespace dea
