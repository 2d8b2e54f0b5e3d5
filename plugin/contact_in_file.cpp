#include "plugin/contact_in_file.h"

#include <fstream>
#include <iterator>
#include <optional>

#include "io/convert/xml_places.h"
#include "src/base/parse.h"

namespace dea {

std::map<std::string, ParameterInFile> contact_in_file(const std::string& path, const std::string& contact) {
  std::ifstream in(path, std::ios::binary);
  if (!in || in.peek() != '<') return {};
  const std::optional<XmlPlaces> places = find_places({std::istreambuf_iterator<char>(in), {}});
  if (!places) return {};
  std::map<std::string, ParameterInFile> parameters;
  for (const XmlPlace& place : places->elements) {
    if (place.name != "contact" || place.value("type") != "dea" || place.value("name") != contact) continue;
    if (!parameters.empty()) return {};  // two of one name
    for (int child : place.children)
      parameters[places->at(child).name] = {trimmed(places->content(child)), places->at(child).value("type"),
                                            places->at(child).line};
  }
  return parameters;
}

}  // namespace dea
