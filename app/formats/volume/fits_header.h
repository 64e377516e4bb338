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

/// FITS files are made of blocks of so many bytes, and headers of cards of so many (FITS 4.0, 3.1 and 4.1).
inline constexpr std::size_t kFitsBlock = 2880, kFitsCard = 80;

/// The cards of one header, in the bytes of a file that outlives it. A keyword that stands there twice has its first
/// value. Safe for untrusted bytes. Any thread.
class FitsHeader {
 public:
  /// The header that begins at `begin`, which lies within the file. At most `most` cards are looked at. Else: what is
  /// wrong.
  [[nodiscard]] static std::variant<FitsHeader, std::string> read(std::span<const std::byte> file, std::size_t begin,
                                                                  std::size_t most);

  /// Cards in front of END.
  [[nodiscard]] std::size_t size() const { return cards_.size() / kFitsCard; }
  /// Where in the file the data follow: at the end of a block, which may be behind the end of the file.
  [[nodiscard]] std::uint64_t data_begin() const { return data_begin_; }

  /// A value as it stands there, quotes included, without blanks at its ends and without the comment; none where there
  /// is no such card or it has no value.
  [[nodiscard]] std::optional<std::string_view> value(std::string_view keyword) const;
  /// A string without its quotes and the blanks at its end (4.2.1). Of a string that goes on in CONTINUE cards the
  /// first part. Anything else is given as it stands; empty where there is none.
  [[nodiscard]] std::string text(std::string_view keyword) const;
  /// A finite number (4.2.3, 4.2.4), quoted or not; an exponent may begin with D.
  [[nodiscard]] std::optional<double> number(std::string_view keyword) const;
  [[nodiscard]] std::optional<std::int64_t> integer(std::string_view keyword) const;
  /// Whether a logical value is T (4.2.2).
  [[nodiscard]] bool is_true(std::string_view keyword) const { return value(keyword) == "T"; }

  /// The values of NAXIS1 to NAXISn; none at the place of one that is missing or no integer.
  [[nodiscard]] std::vector<std::optional<std::int64_t>> axis_lengths(std::size_t n) const;

 private:
  FitsHeader(std::string_view cards, std::uint64_t data_begin) : cards_(cards), data_begin_(data_begin) {}

  std::string_view cards_;
  std::uint64_t data_begin_;
};

/// A header and the extent of its data (3.3, 3.4): an array, a table, or something else.
struct FitsUnit {
  FitsHeader header;
  int bits = 0;                     // BITPIX: 8, 16, 32, 64, or -32 and -64 for floats
  std::vector<std::uint64_t> axes;  // NAXISn
  std::uint64_t groups = 1;         // GCOUNT, of extensions and random groups
  bool is_image = false;            // an array with at least one element
  std::uint64_t end = 0;            // where the next unit would begin; may be behind the end of the file
};

/// The unit that begins at `begin`, 0 for the first. Else: what is wrong with its header.
[[nodiscard]] std::variant<FitsUnit, std::string> read_fits_unit(std::span<const std::byte> file, std::size_t begin,
                                                                 std::size_t most_cards);

}  // namespace gs::app
