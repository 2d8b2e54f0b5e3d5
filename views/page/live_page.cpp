#include "views/page/live_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/files/encoded_text.h"
#include "io/files/free_memory.h"
#include "src/base/error.h"

namespace dea {

namespace {

constexpr double kMemoryPerByte = 5;  // the bytes, packed, as text, and the page
// What portable/page/make_page.py writes; its number rises with what is written here.
constexpr const char* kBegin = "<script type=\"text/plain\" id=\"sample-model\" data-gives-way=\"1\"";
constexpr const char* kEnd = "</script>\n";

std::string bytes_of(const std::string& path) {
  std::optional<std::string> bytes = whole_file(path, kMemoryPerByte);
  if (!bytes) throw InputError(path + ": cannot be read");
  return std::move(*bytes);
}

/// portable/page/page.js unpacks it.
std::string element_of(const PageFile& file) {
  return fmt::format("<script type=\"text/plain\" class=\"given\" data-name=\"{}\" data-kind=\"{}\">{}{}",
                     escaped(utf8(file.name)), file.kind, base64(packed_bytes(bytes_of(file.path))), kEnd);
}

}  // namespace

std::string live_page(const std::string& program, const std::vector<PageFile>& files,
                      const std::vector<std::string>& words) {
  std::string page = bytes_of(program);
  const std::size_t begin = page.find(kBegin);
  const std::size_t end = begin == std::string::npos ? begin : page.find(kEnd, begin);
  if (end == std::string::npos)
    throw InputError(program + ": found no sample in it, expected the page dea.html of this version");
  std::string given;
  for (const PageFile& file : files) given += element_of(file);
  // in base64, so that no word ends the element
  nlohmann::json list = nlohmann::json::array();
  for (const std::string& word : words) list.push_back(utf8(word));
  given += fmt::format("<script type=\"text/plain\" id=\"given-words\">{}{}", base64(list.dump()), kEnd);
  page.replace(begin, end + std::string(kEnd).size() - begin, given);
  return page;
}

}  // namespace dea
