#include "app/formats/dicom/dicom_frame.h"
#include "tests/app/formats/dicom/dicom_builder.h"
#include "tests/app/shared_facts.h"

using namespace gs;
using namespace gs::test;

namespace {

/// Least, greatest and mean stored sample of all frames.
struct Range {
  double least = INFINITY, most = -INFINITY, mean = 0;
};

Range stored_range(const std::string& path, std::array<std::uint32_t, 3>& size) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto parsed = app::read_dicom_file(app::shared_bytes(bytes_of(text)), own_budget());
  INFO(path);
  REQUIRE(std::holds_alternative<app::DicomFile>(parsed));
  const auto& file = std::get<app::DicomFile>(parsed);
  const auto read = app::read_dicom_image(file, {});
  REQUIRE(std::holds_alternative<app::DicomImage>(read));
  const app::DicomPixels& pixels = std::get<app::DicomImage>(read).pixels;
  size = {pixels.columns, pixels.rows, pixels.frames};
  Range range;
  double count = 0;
  for (std::uint32_t frame = 0; frame < pixels.frames; ++frame) {
    std::vector<std::byte> samples;
    const auto problem = app::decode_dicom_frame(file, pixels, frame, samples);
    INFO(problem.value_or(""));
    REQUIRE_FALSE(problem);
    const std::size_t width = pixels.sample_bytes();
    for (std::size_t at = 0; at < samples.size(); at += width) {
      std::int64_t value = 0;
      std::memcpy(&value, samples.data() + at, width);
      if (pixels.is_signed && width < 8 && (value >> (8 * width - 1) & 1) != 0) value -= std::int64_t{1} << (8 * width);
      range.least = std::min(range.least, static_cast<double>(value));
      range.most = std::max(range.most, static_cast<double>(value));
      range.mean += static_cast<double>(value);
      ++count;
    }
  }
  range.mean /= count;
  return range;
}

}  // namespace

TEST_CASE("agrees with other programs about shared DICOM files") {
  const std::string folder = shared_data("dicom");
  if (folder.empty()) return;
  int files = 0;
  for (const SharedFact& fact : shared_facts(folder + "README.md")) {
    const auto least = number_in(fact.text, " min "), most = number_in(fact.text, " max ");
    const auto mean = number_in(fact.text, " mean ");
    if (fact.file.ends_with(".gz") || !least || !most || !mean) continue;
    INFO(fact.file);
    std::array<std::uint32_t, 3> size{};
    const Range range = stored_range(folder + fact.file, size);
    CHECK(range.least == Approx(*least));
    CHECK(range.most == Approx(*most));
    CHECK(range.mean == Approx(*mean).epsilon(1e-6));
    const auto columns = number_in(fact.text, "; "), frames = number_in(fact.text, " frames ");
    CHECK(columns == static_cast<double>(size[0]));
    CHECK(frames == static_cast<double>(size[2]));
    ++files;
  }
  CHECK(files > 40);
}

TEST_CASE("agrees with the volumes that others made of shared DICOM series") {
  const std::string folder = shared_data("dicom");
  if (folder.empty()) return;
  for (const char* const name : {"compressed_jpeg", "compressed_rle", "002_non_isotropic"}) {
    INFO(name);
    const auto series = opened(folder + "dicom2nifti/" + name);
    const auto other = opened(folder + "dicom2nifti/" + name + ".nii.gz");
    std::vector<float> a = values_of(series), b = values_of(other);
    REQUIRE(a.size() == b.size());
    std::ranges::sort(a);
    std::ranges::sort(b);
    for (std::size_t i = 0; i < a.size(); ++i) REQUIRE_EACH(std::abs(a[i] - b[i]) <= 1e-4f * std::abs(b[i]) + 1e-6f);
  }
  const auto head = opened(folder + "philips_ct");
  CHECK(head.layout.dimensions == std::array<std::uint32_t, 3>{512, 512, 20});
  CHECK(head.layout.axes[2].z == Approx(5));
  CHECK(metadata_values(head.layout, "units") == std::vector<std::string>{"HU"});
}
