#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <armature/sdk/error.h>

#include "sdk/io/ply_header.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {

/// Walks the content of a PLY file element by element, in whichever encoding. Every number becomes a double, which
/// holds all of PLY's types exactly.
class PlyRows {
 public:
  /// `bytes` is the whole file.
  PlyRows(std::string_view bytes, std::string_view name, const PlyHeader& header);

  /// To be called before the rows of an element. `list` is the property whose list is wanted, if any. Refuses a count
  /// that the rest of the file has no room for.
  [[nodiscard]] Expected<void> begin(const PlyElement& element, std::optional<std::size_t> list = {});
  /// Reads the next element of the kind begun.
  [[nodiscard]] Expected<void> next();
  /// Whether the file ends here, but for blanks.
  [[nodiscard]] Expected<void> end();

  /// The number of a property of the row just read; 0 for a list.
  [[nodiscard]] double value(std::size_t property) const noexcept { return values_[property]; }
  /// The list that was wanted.
  [[nodiscard]] std::span<const double> list() const noexcept { return list_; }

  /// Whether a line of this element held more numbers than the header says, so that properties may not be what they
  /// are called. Text only: binary content would have lost its step.
  [[nodiscard]] bool surplus() const noexcept { return surplus_; }

  /// What stands for the file in messages.
  [[nodiscard]] std::string_view name() const noexcept { return name_; }
  /// Bytes walked past.
  [[nodiscard]] std::size_t position() const noexcept;
  /// The failure of the row just read: "NAME, line or byte N: expected WHAT; found FOUND".
  [[nodiscard]] tl::unexpected<Error> expected(std::string_view what, std::string_view found) const;

 private:
  Expected<void> next_line();
  Expected<void> next_bytes();
  Expected<void> number(double& out);
  /// Reads one binary number; false where the file is too short.
  bool number(PlyType type, double& out) noexcept;
  [[nodiscard]] std::string row_name() const;

  std::string_view bytes_;
  std::string_view name_;
  const PlyHeader& header_;
  TextScanner scanner_;  // of ASCII content
  std::size_t at_;       // in binary content
  std::size_t row_at_;   // where the row just read began
  const PlyElement* element_ = nullptr;
  std::size_t row_ = 0;
  std::optional<std::size_t> wanted_;
  std::vector<double> values_;
  std::vector<double> list_;
  bool surplus_ = false;
};

}  // namespace armature::sdk
