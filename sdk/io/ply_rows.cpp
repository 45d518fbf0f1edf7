#include "sdk/io/ply_rows.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "sdk/io/place.h"

namespace armature::sdk {
namespace {

/// A number of native byte order out of bytes in the given one.
template <class Number>
double decode(std::string_view bytes, bool swapped) noexcept {
  std::array<char, sizeof(Number)> buffer{};
  for (std::size_t i = 0; i < buffer.size(); ++i) buffer[i] = bytes[swapped ? buffer.size() - 1 - i : i];
  Number number;
  std::memcpy(&number, buffer.data(), buffer.size());
  return static_cast<double>(number);
}

double decode(std::string_view bytes, PlyType type, bool swapped) noexcept {
  switch (type) {
    case PlyType::Int8: return decode<std::int8_t>(bytes, swapped);
    case PlyType::Uint8: return decode<std::uint8_t>(bytes, swapped);
    case PlyType::Int16: return decode<std::int16_t>(bytes, swapped);
    case PlyType::Uint16: return decode<std::uint16_t>(bytes, swapped);
    case PlyType::Int32: return decode<std::int32_t>(bytes, swapped);
    case PlyType::Uint32: return decode<std::uint32_t>(bytes, swapped);
    case PlyType::Float32: return decode<float>(bytes, swapped);
    case PlyType::Float64: break;
  }
  return decode<double>(bytes, swapped);
}

}  // namespace

PlyRows::PlyRows(std::string_view bytes, std::string_view name, const PlyHeader& header)
    : bytes_(bytes),
      name_(name),
      header_(header),
      scanner_(bytes.substr(header.bytes), name, {.comments = false}, header.lines + 1),
      at_(header.bytes),
      row_at_(at_) {}

std::size_t PlyRows::position() const noexcept {
  return header_.encoding == PlyEncoding::Ascii ? header_.bytes + scanner_.position() : at_;
}

Expected<void> PlyRows::begin(const PlyElement& element, std::optional<std::size_t> list) {
  element_ = &element;
  wanted_ = list;
  row_ = 0;
  surplus_ = false;
  values_.assign(element.properties.size(), 0);
  std::size_t least = 0;
  for (const PlyProperty& property : element.properties)
    least += header_.encoding == PlyEncoding::Ascii ? 2 : size_of(property.count.value_or(property.type));
  // The last line of a text may lack its end.
  const std::size_t left = bytes_.size() - position() + 1;
  if (element.count > left / least)
    return fail_at_byte(name_, position(),
                        "expected " + std::to_string(element.count) + " elements " + quoted(element.name) +
                            " of at least " + std::to_string(least) + " bytes; " + std::to_string(left - 1) +
                            " bytes are left");
  return {};
}

Expected<void> PlyRows::next() {
  list_.clear();
  ++row_;
  return header_.encoding == PlyEncoding::Ascii ? next_line() : next_bytes();
}

Expected<void> PlyRows::next_line() {
  if (!scanner_.next_line()) return scanner_.ended(row_name());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const PlyProperty& property = element_->properties[i];
    double first = 0;
    if (auto read = number(first); !read) return read;
    if (!property.count) {
      values_[i] = first;
      continue;
    }
    if (!(first >= 0) || first > 4294967295.0 || first != std::floor(first))
      return scanner_.expected("the length of a list", "something else");
    for (auto left = static_cast<std::uint64_t>(first); left > 0; --left) {
      double value = 0;
      if (auto read = number(value); !read) return read;
      if (wanted_ == i) list_.push_back(value);
    }
  }
  // Some programs write more than their header says.
  double more = 0;
  for (; !scanner_.at_line_end(); surplus_ = true)
    if (auto read = number(more); !read) return read;
  return {};
}

Expected<void> PlyRows::number(double& out) {
  const std::string_view word = scanner_.word();
  const std::optional<double> value = to_double(word);
  if (!value) return scanner_.expected("a number of " + row_name(), word);
  out = *value;
  return {};
}

Expected<void> PlyRows::next_bytes() {
  row_at_ = at_;
  const auto truncated = [&] { return fail_at_byte(name_, at_, "expected " + row_name() + "; the file ends here"); };
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const PlyProperty& property = element_->properties[i];
    if (!property.count) {
      if (!number(property.type, values_[i])) return truncated();
      continue;
    }
    double length = 0;
    if (!number(*property.count, length)) return truncated();
    if (length < 0) return expected("the length of a list", std::to_string(static_cast<std::int64_t>(length)));
    const auto count = static_cast<std::size_t>(length);
    if (count > (bytes_.size() - at_) / size_of(property.type)) return truncated();
    if (wanted_ != i) {
      at_ += count * size_of(property.type);
      continue;
    }
    list_.resize(count);
    for (double& value : list_) (void)number(property.type, value);
  }
  return {};
}

bool PlyRows::number(PlyType type, double& out) noexcept {
  const std::size_t size = size_of(type);
  if (bytes_.size() - at_ < size) return false;
  const bool big = header_.encoding == PlyEncoding::BigEndian;
  out = decode(bytes_.substr(at_, size), type, big != (std::endian::native == std::endian::big));
  at_ += size;
  return true;
}

Expected<void> PlyRows::end() {
  if (header_.encoding == PlyEncoding::Ascii) {
    if (scanner_.next_line()) return scanner_.expected("nothing behind the last element", scanner_.word());
    return {};
  }
  if (bytes_.find_first_not_of(" \t\r\n", at_) != std::string_view::npos)
    return fail_at_byte(
        name_, at_,
        "expected nothing behind the last element; " + std::to_string(bytes_.size() - at_) + " bytes are left");
  return {};
}

tl::unexpected<Error> PlyRows::expected(std::string_view what, std::string_view found) const {
  if (header_.encoding == PlyEncoding::Ascii) return scanner_.expected(what, found);
  return fail_at_byte(name_, row_at_,
                      "expected " + std::string(what) + " in " + row_name() + "; found " + quoted(found));
}

std::string PlyRows::row_name() const {
  return std::string(element_->name.substr(0, 24)) + " " + std::to_string(row_) + " of " +
         std::to_string(element_->count);
}

}  // namespace armature::sdk
