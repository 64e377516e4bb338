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

/// Block size of FITS files, and card size of headers, in bytes (FITS 4.0, 3.1 and 4.1).
inline constexpr std::size_t kFitsBlock = 2880, kFitsCard = 80;

/// Cards of one header, as a view of the file's bytes, which must outlive it. The first value of a repeated keyword
/// counts. Safe for untrusted bytes. Usable on any thread.
class FitsHeader {
 public:
  /// Reads the header at `begin`, which lies within the file. Checks at most `most` cards. Returns a message on
  /// failure.
  [[nodiscard]] static std::variant<FitsHeader, std::string> read(std::span<const std::byte> file, std::size_t begin,
                                                                  std::size_t most);

  /// Number of cards before END.
  [[nodiscard]] std::size_t size() const { return cards_.size() / kFitsCard; }
  /// Returns the file offset of the data, at a block boundary; it may be beyond the end of the file.
  [[nodiscard]] std::uint64_t data_begin() const { return data_begin_; }

  /// Returns a raw value with quotes, trimmed, without its comment. Returns nullopt if the card or its value is
  /// missing.
  [[nodiscard]] std::optional<std::string_view> value(std::string_view keyword) const;
  /// Returns a string without quotes and trailing blanks (4.2.1). Of a string with CONTINUE cards, returns the first
  /// part. Returns other values as they are, and "" if missing.
  [[nodiscard]] std::string text(std::string_view keyword) const;
  /// Returns a finite number (4.2.3, 4.2.4), quoted or not; the exponent may begin with D.
  [[nodiscard]] std::optional<double> number(std::string_view keyword) const;
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view keyword) const;
  /// Reports whether a logical value is T (4.2.2).
  [[nodiscard]] bool is_true(std::string_view keyword) const { return value(keyword) == "T"; }

  /// Returns the values of NAXIS1 to NAXISn; nullopt for each one that is missing or not an integer.
  [[nodiscard]] std::vector<std::optional<std::int64_t>> axis_lengths(std::size_t n) const;

 private:
  FitsHeader(std::string_view cards, std::uint64_t data_begin) : cards_(cards), data_begin_(data_begin) {}

  std::string_view cards_;
  std::uint64_t data_begin_;
};

/// Header and extent of its data (3.3, 3.4): an array, a table, or another kind.
struct FitsUnit {
  FitsHeader header;
  int bits = 0;                     // BITPIX: 8, 16, 32, 64, or -32 and -64 for floats
  std::vector<std::uint64_t> axes;  // axis lengths, NAXISn
  std::uint64_t groups = 1;         // GCOUNT of extensions and random groups
  bool is_image = false;            // array with at least one element
  std::uint64_t end = 0;            // offset of the next unit; may be beyond the end of the file
};

/// Reads the unit at `begin`; 0 is the first one. Returns a message if its header is invalid.
[[nodiscard]] std::variant<FitsUnit, std::string> read_fits_unit(std::span<const std::byte> file, std::size_t begin,
                                                                 std::size_t most_cards);

}  // namespace gs::app
