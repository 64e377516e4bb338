#pragma once

#include "app/base/read_file.h"
#include "app/formats/dicom/dicom_tags.h"
#include "base/budget.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

struct DicomElement;

/// Data set, or item of a sequence: the elements that DicomTag lists.
class DicomDataSet {
 public:
  [[nodiscard]] const DicomElement* find(DicomTag tag) const;
  /// Returns the value as text without padding. Empty if it is missing.
  [[nodiscard]] std::string_view text(DicomTag tag) const;
  /// Returns up to `most` numbers of a value, from text or binary.
  [[nodiscard]] std::vector<double> numbers(DicomTag tag, std::size_t most) const;
  /// Returns the first number of a value if it is finite.
  [[nodiscard]] std::optional<double> number(DicomTag tag) const;
  /// Returns a whole number from 0 to 65535, or `otherwise`.
  [[nodiscard]] std::uint32_t whole(DicomTag tag, std::uint32_t otherwise) const;
  /// Returns the items of a sequence.
  [[nodiscard]] std::span<const DicomDataSet> items(DicomTag sequence) const;
  /// Returns the first item of a sequence, or null.
  [[nodiscard]] const DicomDataSet* item(DicomTag sequence) const;

  std::vector<DicomElement> elements;  // in the order of the file
};

/// Data element. Its value is in the bytes of the file.
struct DicomElement {
  DicomTag tag{};
  bool big_endian = false;
  std::span<const std::byte> value;
  std::vector<DicomDataSet> items;
};

/// Encoding of the pixels (PS3.5, annex A).
enum class DicomCodec : std::uint8_t { native, rle, jpeg, jpeg_lossless, jpeg_ls, jpeg_2000, unknown };

/// DICOM file with its elements. The pixels are not decoded.
struct DicomFile {
  SharedBytes content;  // inflated, if the transfer syntax is deflated
  DicomDataSet data;
  std::string syntax;  // UID of the transfer syntax; empty if the file states none
  DicomCodec codec = DicomCodec::native;
  bool big_endian = false;                            // the native pixels
  std::vector<std::span<const std::byte>> fragments;  // of encoded pixels; the first one is the table of offsets
};

/// Reports whether the first bytes are those of a DICOM file, with or without the preamble of 128 bytes.
[[nodiscard]] bool is_dicom(std::span<const std::byte> bytes);

/// Finds the elements of a file. A file that ends early gives those before its end. Returns a message if it is no DICOM
/// file. Safe for untrusted bytes. Any thread.
[[nodiscard]] std::variant<DicomFile, std::string> read_dicom_file(SharedBytes content, const WorldBudget& budget);

}  // namespace gs::app
