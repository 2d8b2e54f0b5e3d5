// io/feb/feb_xml.h – the syntax all .feb versions share: XML elements.
#pragma once
#include <tinyxml2.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/febio/febio_text.h"
#include "src/model/joint_model.h"

namespace dea::feb {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

/// Loads and parses a file; throws InputError if it is no FEBio XML file.
std::unique_ptr<XMLDocument> load_xml(const std::string& path);

using namespace febio;  // its words and numbers

/// The child elements of an element in the order of the file, or those of one name:
/// for (const XMLElement& child : children(element, "node")).
class Children {
 public:
  struct Iterator {
    const XMLElement* element;
    const char* name;
    const XMLElement& operator*() const { return *element; }
    Iterator& operator++() {
      element = element->NextSiblingElement(name);
      return *this;
    }
    bool operator!=(const Iterator& other) const { return element != other.element; }
  };
  Children(const XMLElement& parent, const char* name) : first_(parent.FirstChildElement(name)), name_(name) {}
  Iterator begin() const { return {first_, name_}; }
  Iterator end() const { return {nullptr, name_}; }

 private:
  const XMLElement* first_;
  const char* name_;
};
inline Children children(const XMLElement& parent, const char* name = nullptr) { return {parent, name}; }

/// The element's text without its children; comments skipped. `store` is used when it is in pieces.
std::string_view text_of(const XMLElement& element, std::string& store);
std::string text_of(const XMLElement& element);

/// Attribute or "" ; child text or "".
std::string attribute(const XMLElement& element, const char* name);
bool is_leaf(const XMLElement& element);

}  // namespace dea::feb
