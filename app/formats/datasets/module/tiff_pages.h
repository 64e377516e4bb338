#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <tiffio.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// How the samples of a page are read: as stored, through its colour table, or converted to RGBA by libtiff.
enum class TiffMode : std::uint8_t { stored, palette, rgba };

/// Form of a page.
struct TiffForm {
  std::uint32_t width = 0, height = 0;
  std::uint16_t samples = 1, bits = 1, format = SAMPLEFORMAT_UINT;
  bool apart = false;  // each sample has its own strips or tiles
  bool tiled = false;
  bool colors = false;
  bool inverted = false;  // bits, of which 0 is white
  TiffMode mode = TiffMode::stored;
  NumberType type = NumberType::none;
  std::uint32_t parts = 1;
  bool operator==(const TiffForm&) const = default;
};

/// Page of a file: the offset of its directory, or that of its pixels if it has none.
struct TiffPage {
  std::uint64_t directory = 0;
  std::optional<std::uint64_t> pixels;
};

/// Open file, with the last message of libtiff.
class TiffHandle {
 public:
  explicit TiffHandle(ArrayBytes bytes);
  TiffHandle(const TiffHandle&) = delete;
  TiffHandle& operator=(const TiffHandle&) = delete;
  ~TiffHandle();

  [[nodiscard]] TIFF* get() const { return tiff_; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_.bytes; }
  /// Returns the function that receives missing bytes, or null if all bytes are present.
  [[nodiscard]] const NeedBytes& need() const { return bytes_.need; }
  /// Returns the last message, or `otherwise`.
  [[nodiscard]] std::string problem(const char* otherwise) const;
  void forget_problem() { problem_.clear(); }

 private:
  static tmsize_t read(thandle_t handle, void* to, tmsize_t size);
  static tmsize_t write(thandle_t handle, void* from, tmsize_t size);
  static toff_t seek(thandle_t handle, toff_t offset, int whence);
  static int close(thandle_t handle);
  static toff_t size(thandle_t handle);
  static int map(thandle_t handle, void** base, toff_t* size);
  static void unmap(thandle_t handle, void* base, toff_t size);
  static int report(TIFF* tiff, void* user, const char* module, const char* format, va_list arguments);
  static int ignore(TIFF* tiff, void* user, const char* module, const char* format, va_list arguments);

  ArrayBytes bytes_;
  toff_t at_ = 0;
  std::string problem_;
  TIFF* tiff_ = nullptr;
};

/// Returns the form of the current page. Its type is none if the page cannot be read. `keep_palette` states that
/// numbers count more than the colours of a table.
[[nodiscard]] TiffForm tiff_form_of(TIFF* tiff, bool keep_palette);

/// Part of a page.
struct TiffBox {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};
/// Reads a part of the current page into `to`, which has its size. Returns an empty text, or a message.
[[nodiscard]] std::string read_tiff_page(TiffHandle& file, const TiffForm& form, const TiffBox& box,
                                         std::span<std::byte> to);

}  // namespace gs::app
