// febiodea/io/feb/feb_xml.h – the syntax all .feb versions share: XML elements, numbers, lists, words.
#pragma once
#include <tinyxml2.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <febiodea/io/febio/febio_rules.h>
#include <febiodea/model/joint_model.h>

namespace dea::feb {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

/// Loads and parses a file; throws InputError if it is no FEBio XML file. `path` is opened, `name` is
/// how messages call it.
std::unique_ptr<XMLDocument> load_xml(const std::string& path, const std::string& name);

using febio::quote;

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
std::string_view trim(std::string_view text);

/// Attribute or "" ; child text or "".
std::string attribute(const XMLElement& element, const char* name);
bool is_leaf(const XMLElement& element);

/// Compares FEBio's enumerated words: upper and lower case are equal.
bool same_word(std::string_view a, std::string_view b);
std::string lower(std::string_view text);

/// Outcome of looking for one number at the start of a text.
enum class Number { Ok, None, NotFinite };

/// Reads a number at the front of `text` (C style: white space, '+', ".5") and removes it. NotFinite: NaN,
/// infinity or beyond 1e30, the largest number a model may have.
Number take_double(std::string_view& text, double& value);
/// Reads an integer at the front of `text` and removes it; None also for one beyond 32 bits.
Number take_int(std::string_view& text, int& value);
/// Removes white space and one comma; false if there is no comma.
bool take_comma(std::string_view& text);

/// The whole text as one number, if it is one.
std::optional<double> whole_double(std::string_view text);
std::optional<int> whole_int(std::string_view text);

/// Comma separated words, not trimmed.
std::vector<std::string> split_words(std::string_view text);

}  // namespace dea::feb
