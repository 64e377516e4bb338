#include "app/formats/volume_texture.h"

#include "tests/app/volume_files.h"

#include <catch2/catch.hpp>

#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

render::Image texture_at(const std::string& path) {
  auto read = read_volume_texture(path, {}, own_budget());
  if (const auto* error = std::get_if<render::ImageError>(&read)) FAIL(error->message);
  return *std::get<Texture>(read).image;
}

const std::string kHeaderOfData = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";

}  // namespace

TEST_CASE("reads the voxels of a NRRD header with a separate data file as a texture") {
  ScratchFolder folder;
  folder.write("a.raw", "\1\2\3\4\5\6\7\10");
  const std::string header = kHeaderOfData + "data file: a.raw\n";
  const render::Image image = texture_at(folder.write("a.nhdr", header));
  CHECK(image.slices == 2);
  CHECK(image.width == 2);
  CHECK(image.height == 4);
  CHECK(image.components == 1);
  // The rows of a slice go from the top down, as those of an image.
  CHECK(image.pixels == std::vector<std::uint8_t>{3, 4, 1, 2, 7, 8, 5, 6});
  CHECK(is_volume_texture(bytes_of(header)));
  CHECK_FALSE(is_volume_texture(bytes_of(kHeaderOfData + "\n12345678")));  // the decoder of images reads it
  CHECK_FALSE(is_volume_texture(bytes_of("\x89PNG\r\n")));
}

TEST_CASE("scales the values of a NIfTI volume to bytes, from the smallest to the largest") {
  ScratchFolder folder;
  Bytes header(352);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof value); };
  put(0, std::int32_t{348});
  const std::int16_t sizes[] = {3, 3, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) put(40 + 2 * i, sizes[i]);
  put(70, std::int16_t{4});  // 16 bits, signed
  put(72, std::int16_t{16});
  put(108, 352.0f);
  put(344, std::array<char, 4>{'n', '+', '1', '\0'});
  const std::int16_t values[] = {-1000, 0, 1000};
  Bytes file = header;
  const auto* first = reinterpret_cast<const std::byte*>(values);
  file.insert(file.end(), first, first + sizeof values);
  CHECK(is_volume_texture(file));
  CHECK(texture_at(folder.write("a.nii", string_of(file))).pixels == std::vector<std::uint8_t>{0, 127, 255});
  CHECK(is_volume_texture(gzipped(file)));
  CHECK(texture_at(folder.write("a.nii.gz", string_of(gzipped(file)))).pixels.size() == 3);
}

TEST_CASE("reports a volume texture with a missing data file or too long sides") {
  ScratchFolder folder;
  const auto message = [&](const std::string& text) {
    const auto read = read_volume_texture(folder.write("a.nhdr", text), {}, own_budget());
    const auto* error = std::get_if<render::ImageError>(&read);
    return error ? error->message : std::string();
  };
  CHECK(message(kHeaderOfData + "data file: none.raw\n").find("the data file") != std::string::npos);
  CHECK(message("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5000 1 1\nencoding: raw\n\n" + std::string(5000, 'x'))
            .find("expected 1 to 4096") != std::string::npos);
}
