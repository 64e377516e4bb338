#include "app/formats/volume_common.h"

#include <fitsio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <utility>

// FITS 4.0 (https://fits.gsfc.nasa.gov/fits_standard.html). cfitsio reads the headers, from memory, so that
// its extended file names are not reached; voxels are taken from the mapped file as they lie there.

namespace gs::app {
namespace {

// Its tables of open files and of messages are shared by all threads.
std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

struct Close {
  void operator()(fitsfile* file) const {
    int status = 0;
    fits_close_file(file, &status);
    fits_clear_errmsg();
  }
};
using Fits = std::unique_ptr<fitsfile, Close>;

std::string error_text(int status) {
  std::array<char, FLEN_STATUS> text{};
  fits_get_errstatus(status, text.data());
  return text.data();
}

std::optional<double> number_key(const Fits& file, const std::string& key) {
  double value = 0;
  int status = 0;
  fits_read_key(file.get(), TDOUBLE, key.c_str(), &value, nullptr, &status);
  return status == 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string text_key(const Fits& file, const std::string& key) {
  std::array<char, FLEN_VALUE> value{};
  int status = 0;
  fits_read_key(file.get(), TSTRING, key.c_str(), value.data(), nullptr, &status);
  return status == 0 ? value.data() : "";
}

/// True when an image follows the current header and its data. The library must not see a table: it makes
/// room for as many columns as one claims to have.
bool image_follows(const Fits& file, std::span<const std::byte> bytes) {
  LONGLONG head = 0, data = 0, end = 0;
  int status = 0;
  if (fits_get_hduaddrll(file.get(), &head, &data, &end, &status) != 0) return false;
  if (end < 0 || static_cast<std::uint64_t>(end) > bytes.size()) return false;
  return text_of(bytes.subspan(static_cast<std::size_t>(end))).starts_with("XTENSION= 'IMAGE ");
}

/// The lengths of the first image; its header is the current one then. Only images may stand in front of it.
std::variant<std::vector<double>, std::string> find_image(const Fits& file, std::span<const std::byte> bytes) {
  constexpr int kMostUnits = 100, kMostAxes = 16;
  int status = 0;
  for (int unit = 1; unit <= kMostUnits; ++unit) {
    int axes = 0;
    std::array<LONGLONG, kMostAxes> lengths{};
    if (unit > 1 && fits_movabs_hdu(file.get(), unit, nullptr, &status) != 0) break;
    if (fits_get_img_dim(file.get(), &axes, &status) != 0) break;
    if (axes > kMostAxes) return std::to_string(axes) + " axes; expected 2 or 3";
    if (axes > 0 && fits_get_img_sizell(file.get(), axes, lengths.data(), &status) != 0) break;
    if (axes > 0) return std::vector<double>(lengths.begin(), lengths.begin() + axes);
    if (!image_follows(file, bytes))
      return std::string(
          "no image of 2 or 3 axes stands in front of its first table (one compressed in tiles is a table: unpack it "
          "with funpack)");
  }
  if (status != 0) return "no image can be read: " + error_text(status);
  return std::string("the file has no image; expected one of 2 or 3 axes");
}

std::optional<StoredType> type_of(int bits) {
  switch (bits) {
    case BYTE_IMG:
      return StoredType::u8;
    case SHORT_IMG:
      return StoredType::i16;
    case LONG_IMG:
      return StoredType::i32;
    case LONGLONG_IMG:
      return StoredType::i64;
    case FLOAT_IMG:
      return StoredType::f32;
    case DOUBLE_IMG:
      return StoredType::f64;
    default:
      return std::nullopt;
  }
}

// Steps along the axes are taken where they are of one unit and of like size; a cube of the sky and of
// velocity is seen best as it is stored. Signs are left out: as on the sky, east is left.
void place(const Fits& file, std::span<const int> axes, qnv::VolumeLayout& layout) {
  std::array<double, 3> steps{1, 1, 1};
  std::string unit;
  for (std::size_t i = 0; i < axes.size() && i < 3; ++i) {
    const std::string number = std::to_string(axes[i]);
    auto step = number_key(file, "CDELT" + number);
    if (!step) step = number_key(file, "CD" + number + '_' + number);
    if (!step || *step == 0) return;
    const std::string its_unit = lower_case(text_key(file, "CUNIT" + number));
    if (i > 0 && its_unit != unit) return;
    unit = its_unit;
    steps[i] = std::abs(*step);
  }
  if (axes.size() < 3) steps[2] = steps[0];
  constexpr double kMostRatio = 32, kLeast = 1e-15, kMost = 1e15;
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  if (*most > kMostRatio * *least || *least < kLeast || *most > kMost) return;
  for (std::size_t i = 0; i < 3; ++i) layout.axes[i] *= static_cast<float>(steps[i]);
  add_metadata(layout, "space units", unit);
}

void describe(const Fits& file, std::span<const int> axes, qnv::VolumeLayout& layout) {
  static constexpr std::pair<const char*, const char*> kKeys[] = {
      {"OBJECT", "title"},       {"BUNIT", "units"},         {"AUTHOR", "author"}, {"REFERENC", "reference"},
      {"TELESCOP", "telescope"}, {"INSTRUME", "instrument"}, {"DATE-OBS", "date"}, {"ORIGIN", "source"}};
  for (const auto& [key, name] : kKeys) add_metadata(layout, name, text_key(file, key));
  for (const int axis : axes) {
    const std::string number = std::to_string(axis);
    add_metadata(layout, "axis " + number, text_key(file, "CTYPE" + number) + ' ' + text_key(file, "CUNIT" + number));
  }
}

struct FitsImage {
  qnv::VolumeLayout layout;
  StoredVoxels voxels;
};

std::variant<FitsImage, std::string> read_header(const Fits& file, std::span<const std::byte> bytes) {
  auto found = find_image(file, bytes);
  if (auto* problem = std::get_if<std::string>(&found)) return std::move(*problem);
  std::vector<double> sizes;
  std::vector<int> axes;  // their numbers, from 1
  const auto& lengths = std::get<std::vector<double>>(found);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths.size() > 3 && lengths[i] == 1) continue;
    sizes.push_back(lengths[i]);
    axes.push_back(static_cast<int>(i + 1));
  }
  if (sizes.empty()) sizes.push_back(1);
  if (sizes.size() > 3) return std::to_string(sizes.size()) + " axes are longer than 1; expected 2 or 3";
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return std::string("the lengths of the axes are wrong; expected whole numbers from 1 on");
  FitsImage image;
  image.layout.dimensions = *dimensions;
  int bits = 0, status = 0;
  fits_get_img_type(file.get(), &bits, &status);
  const std::optional<StoredType> type = type_of(bits);
  if (status != 0 || !type) return "BITPIX is " + std::to_string(bits) + "; expected 8, 16, 32, 64, -32 or -64";
  LONGLONG head = 0, data = 0, end = 0;
  if (fits_get_hduaddrll(file.get(), &head, &data, &end, &status) != 0 || data < 0)
    return "the data cannot be found: " + error_text(status);
  image.voxels.type = *type;
  image.voxels.big_endian = true;
  image.voxels.offset = static_cast<std::uint64_t>(data);
  image.layout.slope = number_key(file, "BSCALE").value_or(1);
  image.layout.intercept = number_key(file, "BZERO").value_or(0);
  if (bits > 0) image.layout.missing = number_key(file, "BLANK");  // only of integers (4.4.2.5)
  place(file, axes, image.layout);
  describe(file, axes, image.layout);
  return image;
}

}  // namespace

bool is_fits(std::span<const std::byte> bytes) { return text_of(bytes).starts_with("SIMPLE  ="); }

VolumeResult open_fits(const VolumeFile& file) {
  if (!is_fits(file.content.bytes)) return std::string("the file does not begin with 'SIMPLE  ='");
  const std::lock_guard lock(library_mutex());
  int status = 0;
  fitsfile* opened = nullptr;
  void* memory = const_cast<std::byte*>(file.content.bytes.data());  // READONLY: is not written to
  std::size_t size = file.content.bytes.size();
  fits_open_memfile(&opened, "volume", READONLY, &memory, &size, 0, nullptr, &status);
  const Fits fits(opened);
  if (status != 0 || !fits) {
    fits_clear_errmsg();
    return "the header cannot be read: " + error_text(status);
  }
  auto read = read_header(fits, file.content.bytes);
  if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
  FitsImage& image = std::get<FitsImage>(read);
  image.voxels.content = file.content;
  return make_source(std::move(image.layout), std::move(image.voxels));
}

}  // namespace gs::app
