// VTP, VTK's surfaces as XML: numbers as text, or as bytes in base64 or appended behind the XML, packed by zlib or not.
#include <fmt/format.h>
#include <tinyxml2.h>

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "io/files/encoded_text.h"
#include "io/files/free_memory.h"
#include "io/surfaces/surface_text.h"
#include "src/base/error.h"
#include "src/base/names.h"

namespace dea {

namespace {

using Xml = tinyxml2::XMLElement;

constexpr const char* kSaveAs = "save the surface as STL or PLY";

/// The file, with what its first line says of bytes.
struct Vtp {
  std::string path;
  bool big_endian = false;
  bool long_counts = false;    ///< UInt64, else UInt32
  bool packed = false;         ///< by zlib
  std::string_view appended;   ///< behind its "_"
  bool appended_text = false;  ///< as base64
};

[[noreturn]] void refuse(const Vtp& file, const Xml* at, const std::string& text) {
  throw InputError(file.path, at == nullptr ? 0 : at->GetLineNum(), text);
}

/// Bytes of a data array, from its first to no known end: as they are, or as base64, in which each part that was
/// written by itself has its own end.
class Stream {
 public:
  Stream(const Vtp& file, const Xml* array, std::string_view content, bool text)
      : file_(file), array_(array), content_(content), text_(text) {}

  /// The next part's first bytes; the place stays. Both the counts before packed bytes and these are a part.
  std::string peek(std::size_t count) const {
    const std::size_t needed = text_ ? text_size(count) : count;
    if (needed > content_.size())
      refuse(file_, array_, "found the end of its bytes, expected more: the file is cut off");
    if (!text_) return std::string(content_.substr(0, count));
    std::optional<std::string> bytes = bytes_of_base64(content_.substr(0, needed));
    if (!bytes || bytes->size() < count)
      refuse(file_, array_, "found text that is no base64, expected bytes as base64");
    bytes->resize(count);
    return std::move(*bytes);
  }
  void skip_part(std::size_t count) { content_.remove_prefix(text_ ? text_size(count) : count); }
  /// More bytes than these can never come.
  std::size_t most() const { return content_.size(); }

 private:
  static std::size_t text_size(std::size_t count) { return (count + 2) / 3 * 4; }

  const Vtp& file_;
  const Xml* array_;
  std::string_view content_;
  bool text_;
};

template <class Stored, class Number>
void append(const Vtp& file, const std::string& bytes, std::vector<Number>& values) {
  for (std::size_t i = 0; i + sizeof(Stored) <= bytes.size(); i += sizeof(Stored))
    values.push_back(static_cast<Number>(number_in<Stored>(std::string_view(bytes).substr(i), file.big_endian)));
}

std::vector<std::uint64_t> counts_in(const Vtp& file, const std::string& bytes) {
  std::vector<std::uint64_t> counts;
  if (file.long_counts)
    append<std::uint64_t>(file, bytes, counts);
  else
    append<std::uint32_t>(file, bytes, counts);
  return counts;
}

/// Packed: how many blocks, their size, that of the last one (0: like the others), their sizes packed; then the blocks.
std::string unpacked(const Vtp& file, const Xml* array, Stream& stream) {
  constexpr std::uint64_t kMostRatio = 1040, kLittle = 4096;  // zlib packs no more than 1032 bytes into one
  const std::size_t size = file.long_counts ? 8 : 4;
  const std::uint64_t blocks = counts_in(file, stream.peek(size))[0];
  if (blocks > stream.most() / size)
    refuse(file, array, fmt::format("found {} blocks, expected fewer: the file is damaged", blocks));
  const std::vector<std::uint64_t> counts = counts_in(file, stream.peek((3 + blocks) * size));
  stream.skip_part((3 + blocks) * size);
  std::uint64_t whole = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (counts[3 + b] > stream.most())
      refuse(file, array, "found a block longer than the file, expected less: it is cut off");
    whole += counts[3 + b];
  }
  if (whole > stream.most()) refuse(file, array, "found blocks longer than the file, expected less: it is cut off");
  if (blocks > 0) need_memory(file.path, 3.0 * static_cast<double>(blocks) * static_cast<double>(counts[1]));
  const std::string all = blocks == 0 ? "" : stream.peek(whole);
  std::string bytes;
  std::size_t place = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint64_t full = b + 1 == blocks && counts[2] > 0 ? counts[2] : counts[1], room = counts[3 + b];
    const std::optional<std::string> block =
        full <= kMostRatio * room + kLittle ? unpacked_bytes(all.substr(place, room), full) : std::nullopt;
    if (!block) refuse(file, array, "found bytes that zlib cannot unpack, expected packed ones: the file is damaged");
    bytes += *block;
    place += room;
  }
  return bytes;
}

/// The bytes of an array that is no text.
std::string bytes_of(const Vtp& file, const Xml* array, const std::string& format) {
  std::string_view content;
  std::string inline_text;  // without white space
  bool text = true;
  if (format == "appended") {
    const long long offset = array->Int64Attribute("offset", -1);
    if (offset < 0 || static_cast<unsigned long long>(offset) > file.appended.size())
      refuse(file, array, "found an offset outside the appended data, expected one within: the file is cut off");
    content = file.appended.substr(static_cast<std::size_t>(offset));
    text = file.appended_text;
  } else {
    inline_text = array->GetText() == nullptr ? "" : array->GetText();
    std::erase_if(inline_text, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
    content = inline_text;
  }
  Stream stream(file, array, content, text);
  if (file.packed) return unpacked(file, array, stream);
  const std::size_t size = file.long_counts ? 8 : 4;
  const std::uint64_t count = counts_in(file, stream.peek(size))[0];
  if (count > stream.most())
    refuse(file, array, "found more bytes named than there are, expected fewer: the file is cut off");
  return stream.peek(size + count).substr(size);
}

/// The numbers of the <DataArray> of this name (nullptr: of the first), coordinates as double, others as long long.
template <class Number>
std::vector<Number> numbers(const Vtp& file, const Xml* parent, const char* name) {
  const Xml* array = parent == nullptr ? nullptr : parent->FirstChildElement("DataArray");
  while (array != nullptr && name != nullptr && !array->Attribute("Name", name))
    array = array->NextSiblingElement("DataArray");
  if (array == nullptr)
    refuse(file, parent, fmt::format("found no <DataArray> of {}, expected one", name == nullptr ? "points" : name));
  const std::string format = array->Attribute("format") == nullptr ? "ascii" : array->Attribute("format");
  std::vector<Number> values;
  if (format == "ascii") {
    SurfaceText text(file.path, array->GetText() == nullptr ? "" : array->GetText());
    for (SurfaceText ahead = text; !ahead.next_word().empty(); ahead = text) {
      if constexpr (std::is_floating_point_v<Number>)
        values.push_back(text.next_number("a coordinate"));
      else
        values.push_back(text.next_integer(name));
    }
    return values;
  }
  if (format != "binary" && format != "appended")
    refuse(file, array, fmt::format("found format=\"{}\", expected ascii, binary or appended", shown(format)));
  const std::string type = array->Attribute("type") == nullptr ? "" : array->Attribute("type");
  const std::string bytes = bytes_of(file, array, format);
  if constexpr (std::is_floating_point_v<Number>) {
    if (type == "Float32")
      append<float>(file, bytes, values);
    else if (type == "Float64")
      append<double>(file, bytes, values);
    else
      refuse(file, array, fmt::format("found the type \"{}\", expected Float32 or Float64", shown(type)));
  } else {
    if (type == "Int32")
      append<std::int32_t>(file, bytes, values);
    else if (type == "Int64")
      append<std::int64_t>(file, bytes, values);
    else if (type == "UInt32")
      append<std::uint32_t>(file, bytes, values);
    else if (type == "UInt64")
      append<std::uint64_t>(file, bytes, values);
    else
      refuse(file, array, fmt::format("found the type \"{}\", expected Int32, Int64, UInt32 or UInt64", shown(type)));
  }
  return values;
}

void read_piece(const Vtp& file, const Xml* piece, TriangleSurface& all) {
  TriangleSurface surface;
  const Xml* points = piece->FirstChildElement("Points");
  const std::vector<double> x = numbers<double>(file, points, nullptr);
  if (x.size() % 3 != 0)
    refuse(file, points, fmt::format("found {} coordinates, expected three for each point", x.size()));
  for (std::size_t i = 0; i < x.size(); i += 3) surface.points.emplace_back(x[i], x[i + 1], x[i + 2]);
  const Xml* polygons = piece->FirstChildElement("Polys");
  const std::vector<long long> corners = numbers<long long>(file, polygons, "connectivity"),
                               ends = numbers<long long>(file, polygons, "offsets");
  const SurfaceText place(file.path, "");
  long long begin = 0;
  for (const long long end : ends) {
    if (end < begin || end > static_cast<long long>(corners.size()))
      refuse(file, polygons, fmt::format("found the offset {}, expected offsets that grow to {}", end, corners.size()));
    place.add_polygon(surface, {corners.begin() + begin, corners.begin() + end});
    begin = end;
  }
  all.append(surface);
}

/// Takes the appended data, which may be no XML, away from the content, and notes them. The rest is XML.
std::string take_appended(std::string_view content, Vtp& file) {
  const std::size_t at = content.find("<AppendedData");
  if (at == std::string_view::npos) return std::string(content);
  const std::size_t tag = content.find('>', at);
  const std::size_t begin = tag == std::string_view::npos ? tag : content.find('_', tag);
  if (begin == std::string_view::npos)
    throw InputError(file.path, 0, "found appended data without \"_\" before them, expected a VTP file: it is cut off");
  file.appended_text = content.substr(at, tag - at).find("raw") == std::string_view::npos;
  file.appended = content.substr(begin + 1);
  return std::string(content.substr(0, at)) + "</VTKFile>";
}

}  // namespace

TriangleSurface read_vtp(const std::string& path, std::string_view content) {
  Vtp file;
  file.path = path;
  const std::string xml = take_appended(content, file);
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(path, document.ErrorLineNum(), "found no XML, expected a VTP file: it is damaged or cut off");
  const Xml* root = document.FirstChildElement("VTKFile");
  const Xml* data = root == nullptr ? nullptr : root->FirstChildElement("PolyData");
  if (data == nullptr) throw InputError(path, 0, "found XML without <VTKFile> and <PolyData>, expected a VTP surface");
  file.big_endian = root->Attribute("byte_order", "BigEndian") != nullptr;
  file.long_counts = root->Attribute("header_type", "UInt64") != nullptr;
  if (const char* compressor = root->Attribute("compressor")) {
    file.packed = std::string_view(compressor) == "vtkZLibDataCompressor";
    if (!file.packed && *compressor != '\0')
      refuse(file, root,
             fmt::format("found the compressor \"{}\", expected vtkZLibDataCompressor or none: {}", shown(compressor),
                         kSaveAs));
  }
  TriangleSurface surface;
  for (const Xml* piece = data->FirstChildElement("Piece"); piece != nullptr;
       piece = piece->NextSiblingElement("Piece"))
    read_piece(file, piece, surface);
  return surface;
}

}  // namespace dea
