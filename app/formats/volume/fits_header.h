#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Sizes in bytes of a block of a FITS file and of a header card (FITS 4.0, 3.1 and 4.1).
inline constexpr std::size_t kFitsBlock = 2880, kFitsCard = 80;

/// Cards of one header, as a view of the file's bytes. The bytes must outlive the view. If a keyword is repeated, its
/// first value counts. Safe for untrusted bytes. Any thread.
class FitsHeader {
 public:
  /// Reads the header at `begin`, which must be inside the file. Checks at most `most` cards. Returns a message on
  /// failure.
  [[nodiscard]] static std::variant<FitsHeader, std::string> read(std::span<const std::byte> file, std::size_t begin,
                                                                  std::size_t most);

  /// Returns the number of cards before END.
  [[nodiscard]] std::size_t size() const { return cards_.size() / kFitsCard; }
  /// Returns the offset of the data in the file, at a block boundary. The offset may exceed the size of the file.
  [[nodiscard]] std::uint64_t data_begin() const { return data_begin_; }

  /// Returns the raw value of a keyword, with quotes, trimmed, without its comment. Returns nullopt if the card or its
  /// value is missing.
  [[nodiscard]] std::optional<std::string_view> value(std::string_view keyword) const;
  /// Returns a string without its quotes and trailing blanks (4.2.1). If CONTINUE cards follow, returns only the first
  /// part. Returns other values unchanged, and "" for a missing value.
  [[nodiscard]] std::string text(std::string_view keyword) const;
  /// Returns a finite number (4.2.3, 4.2.4), in quotes or not. The exponent may begin with D. Returns nullopt
  /// otherwise.
  [[nodiscard]] std::optional<double> number(std::string_view keyword) const;
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view keyword) const;
  /// Returns true if the keyword has the logical value T (4.2.2).
  [[nodiscard]] bool is_true(std::string_view keyword) const { return value(keyword) == "T"; }

  /// Returns the values of NAXIS1 to NAXISn. A value that is missing or not an integer is nullopt.
  [[nodiscard]] std::vector<std::optional<std::int64_t>> axis_lengths(std::size_t n) const;

 private:
  FitsHeader(std::string_view cards, std::uint64_t data_begin) : cards_(cards), data_begin_(data_begin) {}

  std::string_view cards_;
  std::uint64_t data_begin_;
};

/// Header with the extent of its data (3.3, 3.4). The data are an array, a table, or another kind.
struct FitsUnit {
  FitsHeader header;
  int bits = 0;  // BITPIX: 8, 16, 32 or 64 for integers, -32 or -64 for floats
  std::vector<std::uint64_t> axes;  // axis lengths, NAXIS1 to NAXISn
  std::uint64_t groups = 1;  // GCOUNT, for extensions and random groups
  bool is_image = false;            // array with at least one element
  std::uint64_t end = 0;  // offset of the next unit; may exceed the size of the file
};

/// Reads the unit at offset `begin`. The first unit is at 0. Returns a message if the header is invalid.
[[nodiscard]] std::variant<FitsUnit, std::string> read_fits_unit(std::span<const std::byte> file, std::size_t begin,
                                                                 std::size_t most_cards);

}  // namespace gs::app
