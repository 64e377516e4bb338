#pragma once

#include "tests/app/volume_files.h"

#include <cstdint>
#include <string>
#include <vector>

/// Writer of TIFF files for tests.
namespace gs::test {

/// Page of a file: uncompressed pixels in one strip.
struct TiffPageOf {
  std::uint32_t width = 3, height = 2;
  std::uint16_t bits = 8, format = 1, samples = 1, photometric = 1, compression = 1;
  Bytes pixels;
  std::string description = {};
  double resolution = 0;  // pixels per unit
};

/// Returns a file with these pages.
inline std::string tiff_file(const std::vector<TiffPageOf>& pages, bool big_endian = false, bool big_tiff = false) {
  Bytes all = bytes_of(big_endian ? "MM" : "II");
  const auto put_number = [&](Bytes& to, std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      to.push_back(static_cast<std::byte>(value >> 8 * (big_endian ? size - 1 - i : i) & 0xff));
  };
  const std::size_t word = big_tiff ? 8 : 4;
  put_number(all, big_tiff ? 43 : 42, 2);
  if (big_tiff) put_number(all, 8, 2), put_number(all, 0, 2);
  std::size_t link = all.size();
  put_number(all, 0, word);
  const auto set = [&](std::size_t at, std::uint64_t value) {
    Bytes raw;
    put_number(raw, value, word);
    std::copy(raw.begin(), raw.end(), all.begin() + static_cast<std::ptrdiff_t>(at));
  };
  for (const TiffPageOf& page : pages) {
    const std::size_t pixels = all.size();
    all = all + page.pixels;
    const std::size_t text = all.size();
    all = all + bytes_of(page.description);
    all.push_back(std::byte{0});
    if (all.size() % 2 != 0) all.push_back(std::byte{0});
    const std::size_t ratio = all.size();
    put_number(all, static_cast<std::uint64_t>(page.resolution * 1000), 4);
    put_number(all, 1000, 4);
    struct Field {
      std::uint16_t tag, type;
      std::uint64_t count, value;
      std::size_t size;
    };
    const std::size_t bits = all.size();
    for (std::uint16_t i = 0; i < page.samples; ++i) put_number(all, page.bits, 2);
    if (all.size() % 2 != 0) all.push_back(std::byte{0});
    const bool fits = page.samples * 2u <= word;
    std::vector<Field> fields{{256, 4, 1, page.width, 4}, {257, 4, 1, page.height, 4}};
    fields.push_back(
        {258, 3, page.samples, fits && page.samples == 1 ? page.bits : bits, fits && page.samples == 1 ? 2u : word});
    fields.push_back({259, 3, 1, page.compression, 2});
    fields.push_back({262, 3, 1, page.photometric, 2});
    if (!page.description.empty()) fields.push_back({270, 2, page.description.size() + 1, text, word});
    fields.push_back({273, static_cast<std::uint16_t>(big_tiff ? 16 : 4), 1, pixels, word});
    fields.push_back({277, 3, 1, page.samples, 2});
    fields.push_back({278, 4, 1, page.height, 4});
    fields.push_back({279, static_cast<std::uint16_t>(big_tiff ? 16 : 4), 1, page.pixels.size(), word});
    if (page.resolution > 0 && !big_tiff) {
      fields.push_back({282, 5, 1, ratio, word});
      fields.push_back({283, 5, 1, ratio, word});
      fields.push_back({296, 3, 1, 1, 2});
    }
    fields.push_back({339, 3, 1, page.format, 2});
    set(link, all.size());
    put_number(all, fields.size(), big_tiff ? 8 : 2);
    for (const Field& field : fields) {
      put_number(all, field.tag, 2);
      put_number(all, field.type, 2);
      put_number(all, field.count, word);
      put_number(all, field.value, field.size);
      for (std::size_t i = field.size; i < word; ++i) all.push_back(std::byte{0});
    }
    link = all.size();
    put_number(all, 0, word);
  }
  return string_of(all);
}

}  // namespace gs::test
