// io/convert/xml_places.h – where every XML element of a text begins and ends, and edits by these places.
//
// For changing a few elements of a file whose other bytes must stay as they are: line ends, encoding, comments, the way
// numbers are written. The text has been read before (io/feb), so it is known to be well-formed.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dea {

struct XmlAttribute {
  std::string name;
  std::string value;               ///< entities resolved
  std::size_t begin = 0, end = 0;  ///< of the value between the quotes
};

/// An element `<name ...>content</name>` or `<name .../>`; offsets in bytes from the start of the text.
struct XmlPlace {
  std::string name;
  std::size_t begin = 0;        ///< of '<'
  std::size_t open_end = 0;     ///< after the '>' of the start tag
  std::size_t close_begin = 0;  ///< of the end tag; equals open_end for `<name/>`
  std::size_t end = 0;          ///< after the element
  int line = 0;                 ///< of `begin`, 1-based
  int parent = -1;
  std::vector<int> children;
  std::vector<XmlAttribute> attributes;

  bool self_closing() const { return close_begin == end; }
  const XmlAttribute* attribute(std::string_view wanted) const;
  std::string value(std::string_view wanted) const;  ///< of an attribute; "" without
};

struct XmlPlaces {
  std::string text;
  std::vector<XmlPlace> elements;  ///< in the order of their start tags; [0] is the root

  const XmlPlace& at(int element) const { return elements[static_cast<std::size_t>(element)]; }
  std::vector<int> children(int parent, std::string_view name) const;
  int child(int parent, std::string_view name) const;  ///< the first; -1: none
  std::string content(int element) const;              ///< text between the tags, entities resolved, comments out
};

/// Children of nodes, elements, surfaces and sets of the mesh are passed over. Nothing: the text is not what is
/// expected.
std::optional<XmlPlaces> find_places(std::string text);

/// A line of new text: `depth` levels deeper than the place it is put at.
struct XmlLine {
  int depth = 0;
  std::string text;
};
using XmlLines = std::vector<XmlLine>;
void append(XmlLines& lines, const XmlLines& more);
/// `<start>`, the content a level deeper, `</name>`. `start`: the name, and attributes behind it.
XmlLines element_lines(const std::string& start, const XmlLines& content);

/// Changes of a text, gathered and made at once. New lines take the indentation and the line ends of their
/// surroundings.
class XmlEdits {
 public:
  explicit XmlEdits(const XmlPlaces& places);

  void set_attribute(int element, std::string_view name, const std::string& value);  ///< must be there
  void remove_attribute(int element, std::string_view name);
  void set_content(int element, const std::string& text);
  void set_content(int element, const XmlLines& lines);
  void append_child(int element, const XmlLines& lines);  ///< after the last child
  void insert_after(int element, const XmlLines& lines);
  /// With its line; a parent that is left without children goes too, up to the root's children.
  void remove(int element);

  std::string apply() const;

 private:
  struct Edit {
    std::size_t begin = 0, end = 0;
    std::string text;
  };
  std::string indent_of(std::size_t begin) const;  ///< white space before it on its line
  bool starts_line(std::size_t begin) const;
  std::string join(const XmlLines& lines, const std::string& indent) const;  ///< each line after a line end
  std::vector<char> removed_with_empty_parents() const;
  std::vector<Edit> removals(const std::vector<char>& removed) const;
  Edit appended(int element, const XmlLines& lines, const std::vector<char>& removed) const;
  std::string applied(std::vector<Edit> edits) const;

  const XmlPlaces& places_;
  std::string line_end_, unit_;
  std::vector<Edit> edits_;
  std::map<int, XmlLines> appended_, after_;
  std::vector<char> removed_;
};

}  // namespace dea
