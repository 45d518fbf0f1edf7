#include "sdk/io/ply_header.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <utility>

#include "sdk/io/polygons.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};

constexpr std::array<TypeName, 16> kTypeNames = {{{"char", PlyType::Int8},
                                                  {"uchar", PlyType::Uint8},
                                                  {"short", PlyType::Int16},
                                                  {"ushort", PlyType::Uint16},
                                                  {"int", PlyType::Int32},
                                                  {"uint", PlyType::Uint32},
                                                  {"float", PlyType::Float32},
                                                  {"double", PlyType::Float64},
                                                  {"int8", PlyType::Int8},
                                                  {"uint8", PlyType::Uint8},
                                                  {"int16", PlyType::Int16},
                                                  {"uint16", PlyType::Uint16},
                                                  {"int32", PlyType::Int32},
                                                  {"uint32", PlyType::Uint32},
                                                  {"float32", PlyType::Float32},
                                                  {"float64", PlyType::Float64}}};

std::optional<PlyType> type_named(std::string_view name) {
  const auto* const found =
      std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& t) { return t.name == name; });
  if (found == kTypeNames.end()) return {};
  return found->type;
}

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, std::string_view name)
      : bytes_(bytes), scanner_(bytes, name, {.comments = false}) {}

  Expected<PlyHeader> parse() {
    if (!scanner_.next_line()) return scanner_.ended("the keyword ply");
    if (const auto word = scanner_.word(); word != "ply") return scanner_.expected("the keyword ply", word);
    if (auto read = format(); !read) return tl::unexpected(read.error());
    for (;;) {
      if (!scanner_.next_line()) return scanner_.ended("end_header");
      const std::string_view keyword = scanner_.word();
      if (keyword == "end_header") break;
      if (keyword == "comment" || keyword == "obj_info") {
        (void)scanner_.rest_of_line();
        continue;
      }
      auto read = keyword == "element"    ? element()
                  : keyword == "property" ? property()
                                          : scanner_.expected("element, property, comment or end_header", keyword);
      if (!read) return tl::unexpected(read.error());
    }
    for (const PlyElement& element : header_.elements)
      if (element.properties.empty())
        return scanner_.expected("a property of element " + std::string(element.name), "end_header");
    if (!finish()) return scanner_.ended("what the header announces");
    return std::move(header_);
  }

 private:
  Expected<void> format() {
    if (!scanner_.next_line()) return scanner_.ended("format");
    if (const auto word = scanner_.word(); word != "format") return scanner_.expected("format", word);
    const std::string_view encoding = scanner_.word();
    if (encoding == "ascii")
      header_.encoding = PlyEncoding::Ascii;
    else if (encoding == "binary_little_endian")
      header_.encoding = PlyEncoding::LittleEndian;
    else if (encoding == "binary_big_endian")
      header_.encoding = PlyEncoding::BigEndian;
    else
      return scanner_.expected("ascii, binary_little_endian or binary_big_endian", encoding);
    if (const auto version = scanner_.word(); version != "1.0") return scanner_.expected("version 1.0", version);
    return {};
  }

  Expected<void> element() {
    const std::string_view name = scanner_.word();
    if (name.empty()) return scanner_.expected("the name of an element", name);
    const std::string_view word = scanner_.word();
    const std::optional<std::int64_t> count = to_integer(word);
    if (!count || *count < 0 || *count > static_cast<std::int64_t>(kMostElements))
      return scanner_.expected("a number of elements below 4294967295", word);
    header_.elements.push_back({.name = name, .count = static_cast<std::size_t>(*count)});
    return {};
  }

  Expected<void> property() {
    if (header_.elements.empty()) return scanner_.expected("an element before its properties", "property");
    PlyProperty property;
    std::string_view word = scanner_.word();
    if (word == "list") {
      word = scanner_.word();
      property.count = type_named(word);
      if (!property.count || property.count >= PlyType::Float32)
        return scanner_.expected("an integer type such as uchar for the length of a list", word);
      word = scanner_.word();
    }
    const std::optional<PlyType> type = type_named(word);
    if (!type) return scanner_.expected("a type such as float or uchar", word);
    property.type = *type;
    property.name = scanner_.word();
    if (property.name.empty()) return scanner_.expected("the name of a property", property.name);
    header_.elements.back().properties.push_back(property);
    return {};
  }

  /// Finds where the content begins. Its first byte may look like a line's end, so the header's own lines tell.
  bool finish() {
    std::size_t at = scanner_.position();
    const std::size_t first_end = bytes_.find_first_of("\r\n");
    const bool crlf = bytes_.substr(first_end, 2) == "\r\n";
    const std::string_view end = crlf ? "\r\n" : bytes_.substr(first_end, 1);
    if (bytes_.substr(at, end.size()) != end) return false;
    at += end.size();
    header_.bytes = at;
    header_.lines = scanner_.line();
    return true;
  }

  std::string_view bytes_;
  TextScanner scanner_;
  PlyHeader header_;
};

}  // namespace

std::optional<std::size_t> PlyElement::find(std::initializer_list<std::string_view> names) const noexcept {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (std::find(names.begin(), names.end(), properties[i].name) != names.end()) return i;
  return {};
}

std::size_t size_of(PlyType type) noexcept {
  switch (type) {
    case PlyType::Int8:
    case PlyType::Uint8: return 1;
    case PlyType::Int16:
    case PlyType::Uint16: return 2;
    case PlyType::Int32:
    case PlyType::Uint32:
    case PlyType::Float32: return 4;
    case PlyType::Float64: break;
  }
  return 8;
}

Expected<PlyHeader> parse_ply_header(std::string_view bytes, std::string_view name) {
  return HeaderParser(bytes, name).parse();
}

}  // namespace armature::sdk
