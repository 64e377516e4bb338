#include "app/formats/volume/fits_header.h"
#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

// Reader of FITS 4.0 images (https://fits.gsfc.nasa.gov/fits_standard.html). Reads voxels directly from the mapped
// file. Does not support tile compression (clause 10).

namespace gs::app {
namespace {

/// Returns the first image of the file. Skips tables and other units.
std::variant<FitsUnit, std::string> find_image(std::span<const std::byte> file) {
  constexpr int kMaxUnits = 1000;
  constexpr std::size_t kMaxCards = std::size_t{1} << 17;  // max number of cards in all headers together: 10 MB
  std::size_t cards = kMaxCards;
  std::uint64_t begin = 0;
  for (int unit = 1; unit <= kMaxUnits; ++unit) {
    auto read = read_fits_unit(file, static_cast<std::size_t>(begin), cards);
    if (auto* problem = std::get_if<std::string>(&read)) return "header " + std::to_string(unit) + ": " + *problem;
    FitsUnit& found = std::get<FitsUnit>(read);
    if (found.is_image) return std::move(found);
    if (found.header.is_true("ZIMAGE"))
      return "the image of header " + std::to_string(unit) +
             " is compressed in tiles (ZIMAGE); decompress it with funpack first";
    // The standard allows arbitrary bytes after the last unit (3.5).
    if (found.end >= file.size() || !text_of(file.subspan(found.end)).starts_with("XTENSION="))
      return std::string("the file has no image; expected one of 2 or 3 axes");
    begin = found.end;
    cards -= std::min(cards, found.header.size() + 1);
  }
  return "no image among its first " + std::to_string(kMaxUnits) + " headers";
}

StoredType type_of(int bits) {
  switch (bits) {
    case 8:
      return StoredType::u8;
    case 16:
      return StoredType::i16;
    case 32:
      return StoredType::i32;
    case 64:
      return StoredType::i64;
    case -32:
      return StoredType::f32;
    default:
      return StoredType::f64;
  }
}

// Sets the axis steps of the volume, if the steps have one unit and similar sizes. Otherwise, for example in a cube of
// sky and velocity, equal steps look best. Ignores signs, so that east is left, as on the sky.
void place(const FitsHeader& header, std::span<const int> axes, qnv::VolumeLayout& layout) {
  std::array<double, 3> steps{1, 1, 1};
  std::string unit;
  for (std::size_t i = 0; i < axes.size() && i < 3; ++i) {
    const std::string number = std::to_string(axes[i]);
    auto step = header.number("CDELT" + number);
    if (!step) step = header.number("CD" + number + '_' + number);
    if (!step || *step == 0) return;
    const std::string its_unit = lower_case(header.text("CUNIT" + number));
    if (i > 0 && its_unit != unit) return;
    unit = its_unit;
    steps[i] = std::abs(*step);
  }
  if (axes.size() < 3) steps[2] = steps[0];
  constexpr double kMaxRatio = 32, kMin = 1e-15, kMax = 1e15;
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  if (*most > kMaxRatio * *least || *least < kMin || *most > kMax) return;
  for (std::size_t i = 0; i < 3; ++i) layout.axes[i] *= static_cast<float>(steps[i]);
  add_metadata(layout, "space units", unit);
}

void describe(const FitsHeader& header, std::span<const int> axes, qnv::VolumeLayout& layout) {
  static constexpr std::pair<const char*, const char*> kKeys[] = {
      {"OBJECT", "title"},       {"BUNIT", "units"},         {"AUTHOR", "author"}, {"REFERENC", "reference"},
      {"TELESCOP", "telescope"}, {"INSTRUME", "instrument"}, {"DATE-OBS", "date"}, {"ORIGIN", "source"}};
  for (const auto& [key, name] : kKeys) add_metadata(layout, name, header.text(key));
  for (const int axis : axes) {
    const std::string number = std::to_string(axis);
    add_metadata(layout, "axis " + number, header.text("CTYPE" + number) + ' ' + header.text("CUNIT" + number));
  }
}

}  // namespace

bool is_fits(std::span<const std::byte> bytes) { return text_of(bytes).starts_with("SIMPLE  ="); }

VolumeResult open_fits(const VolumeFile& file) {
  if (!is_fits(file.content.bytes)) return std::string("the file does not begin with 'SIMPLE  ='");
  auto found = find_image(file.content.bytes);
  if (auto* problem = std::get_if<std::string>(&found)) return std::move(*problem);
  const FitsUnit& unit = std::get<FitsUnit>(found);
  const FitsHeader& header = unit.header;
  if (unit.groups != 1) return "GCOUNT is " + std::to_string(unit.groups) + "; expected one image";

  std::vector<double> sizes;
  std::vector<int> axes;  // numbers of the axes, from 1
  for (std::size_t i = 0; i < unit.axes.size(); ++i) {
    if (unit.axes.size() > 3 && unit.axes[i] == 1) continue;
    sizes.push_back(static_cast<double>(unit.axes[i]));
    axes.push_back(static_cast<int>(i + 1));
  }
  if (sizes.empty()) sizes.push_back(1);
  if (sizes.size() > 3) return std::to_string(sizes.size()) + " axes are longer than 1; expected 2 or 3";
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return std::string("the axes are longer than 4294967295; expected shorter ones");

  qnv::VolumeLayout layout;
  layout.dimensions = *dimensions;
  layout.slope = header.number("BSCALE").value_or(1);
  layout.intercept = header.number("BZERO").value_or(0);
  if (unit.bits > 0) layout.missing = header.number("BLANK");  // BLANK exists only for integers (4.4.2.5)
  place(header, axes, layout);
  describe(header, axes, layout);
  StoredVoxels voxels;
  voxels.content = file.content;
  voxels.offset = header.data_begin();
  voxels.type = type_of(unit.bits);
  voxels.big_endian = true;
  return make_source(std::move(layout), std::move(voxels));
}

}  // namespace gs::app
