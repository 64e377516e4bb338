// contact_sheet COLUMNS OUT.png PICTURE.png...: pictures of one size side by side, row by row.
#include "net/files/file.h"
#include "render/image/image.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int count, char** arguments) {
  using namespace gs;
  const int columns = count > 1 ? std::atoi(arguments[1]) : 0;
  if (count < 4 || columns < 1) {
    std::fprintf(stderr, "usage: contact_sheet COLUMNS OUT.png PICTURE.png...\n");
    return 2;
  }
  std::vector<render::Image> pictures;
  for (int i = 3; i < count; ++i) {
    auto file = net::map_file(arguments[i]);
    if (!std::holds_alternative<net::MappedFile>(file)) return 1;
    auto decoded = render::decode_image(std::get<net::MappedFile>(file).bytes());
    if (!std::holds_alternative<render::Image>(decoded)) return 1;
    pictures.push_back(std::move(std::get<render::Image>(decoded)));
    const render::Image &a = pictures.front(), &b = pictures.back();
    if (a.width != b.width || a.height != b.height || b.components != 3) return 1;
  }
  const std::uint32_t width = pictures[0].width, height = pictures[0].height;
  const auto across = std::min(static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(pictures.size()));
  const auto down = (static_cast<std::uint32_t>(pictures.size()) + across - 1) / across;
  render::Image sheet{width * across, height * down, 3, {}};
  sheet.pixels.resize(std::size_t{sheet.width} * sheet.height * 3);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    for (std::uint32_t y = 0; y < height; ++y)
      std::copy_n(pictures[i].pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * width * 3), width * 3,
                  sheet.pixels.begin() +
                      static_cast<std::ptrdiff_t>(((i / across * height + y) * sheet.width + i % across * width) * 3));
  if (const auto problem = net::write_file_atomically(arguments[2], render::encode_png(sheet))) {
    std::fprintf(stderr, "contact_sheet: %s\n", problem->message.c_str());
    return 1;
  }
  return 0;
}
