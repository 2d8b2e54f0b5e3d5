#include "io/convert/xml_places.h"
#include "io/files/encoded_text.h"

#include <algorithm>
#include <cstdlib>

namespace dea {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string resolve_entities(std::string_view text) {
  constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&lt;", '<'},   {"&gt;", '>'},   {"&amp;", '&'},  {"&apos;", '\''}, {"&quot;", '"'}, {"&#9;", '\t'},
      {"&#x9;", '\t'}, {"&#10;", '\n'}, {"&#xA;", '\n'}, {"&#13;", '\r'},  {"&#xD;", '\r'}};
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bool found = false;
    for (const auto& entity : kEntities) {
      if (text.compare(i, entity.first.size(), entity.first) != 0) continue;
      result += entity.second;
      i += entity.first.size() - 1;
      found = true;
      break;
    }
    if (!found) result += text[i];
  }
  return result;
}

/// Their children are many and never edited.
bool is_list(std::string_view name) {
  constexpr std::string_view kLists[] = {"Nodes",       "Elements", "NodeSet", "ElementSet",
                                         "DiscreteSet", "Edge",     "Surface", "SurfaceData"};
  return std::find(std::begin(kLists), std::end(kLists), name) != std::end(kLists);
}

struct Scanner {
  std::string_view text;
  std::size_t at = 0, counted = 0;
  int line = 1;

  int line_of(std::size_t place) {
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(counted),
                                        text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
    counted = place;
    return line;
  }
  bool starts(std::string_view word) const { return text.compare(at, word.size(), word) == 0; }
  bool skip_past(std::string_view word) {
    const std::size_t found = text.find(word, at);
    if (found == text.npos) return false;
    at = found + word.size();
    return true;
  }
  void skip_space() {
    while (at < text.size() && is_space(text[at])) ++at;
  }
  std::string word() {
    const std::size_t begin = at;
    while (at < text.size() && !is_space(text[at]) && text[at] != '=' && text[at] != '/' && text[at] != '>') ++at;
    return std::string(text.substr(begin, at - begin));
  }
};

/// The start tag at '<'. False: not understood.
bool read_start_tag(Scanner& s, XmlPlace& place, bool& empty) {
  place.begin = s.at;
  place.line = s.line_of(s.at);
  ++s.at;
  place.name = s.word();
  while (true) {
    s.skip_space();
    if (s.at >= s.text.size()) return false;
    if (s.starts("/>")) {
      s.at += 2;
      empty = true;
      break;
    }
    if (s.text[s.at] == '>') {
      ++s.at;
      break;
    }
    XmlAttribute attribute;
    attribute.name = s.word();
    s.skip_space();
    if (attribute.name.empty() || s.at >= s.text.size() || s.text[s.at] != '=') return false;
    ++s.at;
    s.skip_space();
    if (s.at >= s.text.size() || (s.text[s.at] != '"' && s.text[s.at] != '\'')) return false;
    const char quote = s.text[s.at++];
    attribute.begin = s.at;
    attribute.end = s.text.find(quote, s.at);
    if (attribute.end == s.text.npos) return false;
    attribute.value = resolve_entities(s.text.substr(attribute.begin, attribute.end - attribute.begin));
    s.at = attribute.end + 1;
    place.attributes.push_back(std::move(attribute));
  }
  place.open_end = place.close_begin = place.end = s.at;
  return true;
}

}  // namespace

const XmlAttribute* XmlPlace::attribute(std::string_view wanted) const {
  for (const XmlAttribute& a : attributes)
    if (a.name == wanted) return &a;
  return nullptr;
}

std::string XmlPlace::value(std::string_view wanted) const {
  const XmlAttribute* found = attribute(wanted);
  return found == nullptr ? std::string() : found->value;
}

std::vector<int> XmlPlaces::children(int parent, std::string_view name) const {
  std::vector<int> found;
  for (int c : at(parent).children)
    if (at(c).name == name) found.push_back(c);
  return found;
}

int XmlPlaces::child(int parent, std::string_view name) const {
  for (int c : at(parent).children)
    if (at(c).name == name) return c;
  return -1;
}

std::string XmlPlaces::content(int element) const {
  const XmlPlace& place = at(element);
  std::string raw = text.substr(place.open_end, place.close_begin - place.open_end);
  for (std::size_t begin = raw.find("<!--"); begin != raw.npos; begin = raw.find("<!--", begin)) {
    const std::size_t end = raw.find("-->", begin);
    raw.erase(begin, end == raw.npos ? end : end + 3 - begin);
  }
  return resolve_entities(raw);
}

std::optional<XmlPlaces> find_places(std::string text) {
  XmlPlaces places;
  places.text = std::move(text);
  Scanner s{places.text};
  std::vector<int> open;
  while (true) {
    s.at = s.text.find('<', s.at);
    if (s.at == s.text.npos) break;
    if (s.starts("<!--")) {
      s.at += 4;  // the comment's end may not overlap its start
      if (!s.skip_past("-->")) return std::nullopt;
    } else if (s.starts("<?")) {
      if (!s.skip_past("?>")) return std::nullopt;
    } else if (s.starts("<!")) {
      return std::nullopt;  // DOCTYPE, CDATA: not in .feb files
    } else if (s.starts("</")) {
      if (open.empty()) return std::nullopt;
      XmlPlace& place = places.elements[static_cast<std::size_t>(open.back())];
      place.close_begin = s.at;
      s.at += 2;
      if (s.word() != place.name || !s.skip_past(">")) return std::nullopt;
      place.end = s.at;
      open.pop_back();
    } else {
      XmlPlace place;
      bool empty = false;
      if (!read_start_tag(s, place, empty)) return std::nullopt;
      place.parent = open.empty() ? -1 : open.back();
      if (place.parent < 0 && !places.elements.empty()) return std::nullopt;
      if (!empty && place.parent >= 0 && is_list(place.name)) {  // up to the first end tag of this name
        const std::string end_tag = "</" + place.name;
        place.close_begin = s.text.find(end_tag, s.at);
        while (place.close_begin != s.text.npos && place.close_begin + end_tag.size() < s.text.size() &&
               s.text[place.close_begin + end_tag.size()] != '>' &&
               !is_space(s.text[place.close_begin + end_tag.size()]))
          place.close_begin = s.text.find(end_tag, place.close_begin + 1);
        if (place.close_begin == s.text.npos) return std::nullopt;
        s.at = place.close_begin;
        if (!s.skip_past(">")) return std::nullopt;
        place.end = s.at;
        empty = true;
      }
      const int index = static_cast<int>(places.elements.size());
      if (place.parent >= 0) places.elements[static_cast<std::size_t>(place.parent)].children.push_back(index);
      if (!empty) open.push_back(index);
      places.elements.push_back(std::move(place));
    }
  }
  if (!open.empty() || places.elements.empty()) return std::nullopt;
  return places;
}

void append(XmlLines& lines, const XmlLines& more) { lines.insert(lines.end(), more.begin(), more.end()); }

XmlLines element_lines(const std::string& start, const XmlLines& content) {
  XmlLines lines = {{0, "<" + start + ">"}};
  for (const XmlLine& line : content) lines.push_back({line.depth + 1, line.text});
  lines.push_back({0, "</" + start.substr(0, start.find(' ')) + ">"});
  return lines;
}

XmlEdits::XmlEdits(const XmlPlaces& places) : places_(places), removed_(places.elements.size(), 0) {
  const std::size_t first = places.text.find('\n');
  line_end_ = first != std::string::npos && first > 0 && places.text[first - 1] == '\r' ? "\r\n" : "\n";
  for (int child : places.at(0).children) {  // a section's own indentation, or that of what is in it
    unit_ = indent_of(places.at(child).begin);
    if (unit_.empty() && !places.at(child).children.empty())
      unit_ = indent_of(places.at(places.at(child).children.front()).begin);
    if (!unit_.empty()) break;
  }
}

bool XmlEdits::starts_line(std::size_t begin) const {
  const std::string& text = places_.text;
  while (begin > 0 && (text[begin - 1] == ' ' || text[begin - 1] == '\t')) --begin;
  return begin == 0 || text[begin - 1] == '\n';
}

std::string XmlEdits::indent_of(std::size_t begin) const {
  if (!starts_line(begin)) return "";
  const std::size_t line = places_.text.rfind('\n', begin == 0 ? 0 : begin - 1);
  const std::size_t first = line == std::string::npos ? 0 : line + 1;
  return places_.text.substr(first, begin - first);
}

std::string XmlEdits::join(const XmlLines& lines, const std::string& indent) const {
  std::string text;
  for (const XmlLine& line : lines) {
    text += line_end_ + indent;
    for (int i = 0; i < line.depth; ++i) text += unit_;
    text += line.text;
  }
  return text;
}

void XmlEdits::set_attribute(int element, std::string_view name, const std::string& value) {
  const XmlAttribute* a = places_.at(element).attribute(name);
  if (a != nullptr) edits_.push_back({a->begin, a->end, escaped(value)});
}

void XmlEdits::remove_attribute(int element, std::string_view name) {
  const XmlAttribute* a = places_.at(element).attribute(name);
  if (a == nullptr) return;
  std::size_t begin = a->begin;
  while (!is_space(places_.text[begin - 1]) || places_.text.compare(begin, name.size(), name) != 0) --begin;
  edits_.push_back({begin - 1, a->end + 1, ""});
}

void XmlEdits::set_content(int element, const std::string& text) {
  const XmlPlace& place = places_.at(element);
  if (place.self_closing()) {
    const std::size_t slash = places_.text.rfind('/', place.end);
    edits_.push_back({slash, place.end, ">" + text + "</" + place.name + ">"});
  } else {
    edits_.push_back({place.open_end, place.close_begin, text});
  }
}

void XmlEdits::set_content(int element, const XmlLines& lines) {
  const std::string indent = indent_of(places_.at(element).begin);
  const std::string text = lines.empty() ? "" : join(lines, indent + unit_) + line_end_ + indent;
  set_content(element, text);
}

void XmlEdits::append_child(int element, const XmlLines& lines) { append(appended_[element], lines); }

void XmlEdits::insert_after(int element, const XmlLines& lines) { append(after_[element], lines); }

void XmlEdits::remove(int element) { removed_[static_cast<std::size_t>(element)] = 1; }

std::vector<char> XmlEdits::removed_with_empty_parents() const {
  std::vector<char> removed = removed_;
  const auto is_removed = [&](int element) { return removed[static_cast<std::size_t>(element)] != 0; };
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 1; i < places_.elements.size(); ++i) {
      const XmlPlace& place = places_.elements[i];
      if (removed[i] || place.children.empty() || place.parent < 0 || appended_.count(static_cast<int>(i)) > 0)
        continue;
      if (!std::all_of(place.children.begin(), place.children.end(), is_removed)) continue;
      removed[i] = more = true;
    }
  }
  return removed;
}

std::vector<XmlEdits::Edit> XmlEdits::removals(const std::vector<char>& removed) const {
  const std::string& text = places_.text;
  const auto inside_removed = [&](int element) {
    for (int p = places_.at(element).parent; p >= 0; p = places_.at(p).parent)
      if (removed[static_cast<std::size_t>(p)]) return true;
    return false;
  };
  std::vector<Edit> edits;
  for (std::size_t i = 1; i < places_.elements.size(); ++i) {
    if (!removed[i] || inside_removed(static_cast<int>(i))) continue;
    const XmlPlace& place = places_.elements[i];
    std::size_t begin = place.begin;
    if (starts_line(begin)) {  // with the line end and the indentation before it
      begin -= indent_of(begin).size();
      if (begin > 0) --begin;
      if (begin > 0 && text[begin] == '\n' && text[begin - 1] == '\r') --begin;
    }
    edits.push_back({begin, place.end, ""});
  }
  return edits;
}

XmlEdits::Edit XmlEdits::appended(int element, const XmlLines& lines, const std::vector<char>& removed) const {
  const XmlPlace& place = places_.at(element);
  const std::string indent = indent_of(place.begin);
  if (place.self_closing()) {
    const std::size_t slash = places_.text.rfind('/', place.end);
    return {slash, place.end, ">" + join(lines, indent + unit_) + line_end_ + indent + "</" + place.name + ">"};
  }
  const bool end_tag_alone = starts_line(place.close_begin);
  int last_kept = -1;
  for (int c : place.children)
    if (!removed[static_cast<std::size_t>(c)]) last_kept = c;
  if (last_kept >= 0) {
    const XmlPlace& last = places_.at(last_kept);
    const bool own_line = starts_line(last.begin);
    const std::string tail = own_line || end_tag_alone ? "" : line_end_ + indent;
    return {last.end, last.end, join(lines, own_line ? indent_of(last.begin) : indent + unit_) + tail};
  }
  const std::string text = join(lines, indent + unit_);
  if (!end_tag_alone) return {place.close_begin, place.close_begin, text + line_end_ + indent};
  const std::size_t begin = place.close_begin - indent_of(place.close_begin).size();  // the end tag keeps its line
  return {begin, begin, text.substr(line_end_.size()) + line_end_};
}

std::string XmlEdits::applied(std::vector<Edit> edits) const {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& a, const Edit& b) { return a.begin != b.begin ? a.begin < b.begin : a.end < b.end; });
  const std::string& text = places_.text;
  std::string result;
  std::size_t done = 0;
  for (const Edit& edit : edits) {
    if (edit.begin < done) continue;  // inside something that is removed or replaced
    result.append(text, done, edit.begin - done);
    result += edit.text;
    done = edit.end;
  }
  result.append(text, done, text.size() - done);
  return result;
}

std::string XmlEdits::apply() const {
  const std::vector<char> removed = removed_with_empty_parents();
  std::vector<Edit> edits = edits_;
  const std::vector<Edit> gone = removals(removed);
  edits.insert(edits.end(), gone.begin(), gone.end());
  for (const auto& entry : appended_) edits.push_back(appended(entry.first, entry.second, removed));
  for (const auto& entry : after_) {
    const XmlPlace& place = places_.at(entry.first);
    edits.push_back({place.end, place.end, join(entry.second, indent_of(place.begin))});
  }
  return applied(std::move(edits));
}

}  // namespace dea
