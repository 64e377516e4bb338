#include "app/formats/datasets/module/tiff_file.h"

#include "app/formats/datasets/module/tiff_pages.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

/// Pages of the same form.
struct TiffSeries {
  TiffForm form;
  std::vector<TiffPage> pages;
  std::vector<double> numbers;  // of the pages in the file
  std::string description;
  std::vector<double> resolution;
  std::optional<double> nodata;
  bool swapped = false;  // pages without directory have the other order of bytes
};

std::string text_field(TIFF* tiff, std::uint32_t tag, std::size_t most) {
  const char* text = nullptr;
  if (!TIFFGetField(tiff, tag, &text) || !text) return {};
  return std::string(text, strnlen(text, most));
}

/// Returns the number after `key` in the description of a file of ImageJ: "images=41".
std::uint64_t number_after(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  std::uint64_t number = 0;
  if (at != std::string_view::npos) {
    const char* const first = text.data() + at + key.size();
    std::from_chars(first, text.data() + text.size(), number);
  }
  return number;
}

class TiffArrays final : public ArrayFile {
 public:
  explicit TiffArrays(ArrayBytes bytes) : file_(std::move(bytes)) {}

  /// Finds the pages. Returns an empty text, or a message.
  [[nodiscard]] std::string find_pages() {
    if (!file_.get()) return file_.problem("no TIFF header");
    constexpr std::size_t kMostPages = 1'000'000;
    // ImageJ writes a colour table with measured values.
    is_imagej_ = text_field(file_.get(), TIFFTAG_IMAGEDESCRIPTION, 16).starts_with("ImageJ=");
    std::size_t number = 0;
    do {
      add_page(static_cast<double>(number));
      foresee_directories();
    } while (++number < kMostPages && TIFFReadDirectory(file_.get()));
    if (series_.empty()) return file_.problem("no page that can be read");
    add_pages_of_imagej();
    for (const TiffSeries& series : series_) {
      ArrayInfo info;
      info.path = "/pages" + (arrays_.empty() ? std::string() : "-" + std::to_string(arrays_.size() + 1));
      info.shape = {series.pages.size(), series.form.height, series.form.width};
      info.type = series.form.type;
      info.parts = series.form.parts;
      info.dimensions = {"page", "y", "x"};
      if (series.form.colors) info.part_names = {"red", "green", "blue"};
      if (series.form.colors && series.form.parts == 4) info.part_names.emplace_back("alpha");
      if (info.part_names.size() != info.parts) info.part_names.clear();
      info.chunk = {1, series.form.height, series.form.width};
      arrays_.push_back(std::move(info));
    }
    return {};
  }

  [[nodiscard]] const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  [[nodiscard]] const std::vector<std::string>& groups() const override { return groups_; }

  [[nodiscard]] std::vector<ArrayAttribute> attributes(const std::string& path) override {
    std::vector<ArrayAttribute> all;
    for (std::size_t i = 0; i < arrays_.size(); ++i) {
      if (arrays_[i].path != path) continue;
      const TiffSeries& series = series_[i];
      if (!series.description.empty()) all.push_back({"description", {}, {series.description}});
      if (!series.resolution.empty()) all.push_back({"resolution", series.resolution, {}});
      all.push_back({"colors", {series.form.colors ? 1.0 : 0.0}, {}});
      if (series.nodata) all.push_back({"nodata", {*series.nodata}, {}});
      all.push_back({"pages", series.numbers, {}});
    }
    return all;
  }

  [[nodiscard]] std::string read(std::size_t array, std::span<const std::uint64_t> first,
                                 std::span<const std::uint64_t> count, std::span<std::byte> to) override {
    if (array >= series_.size() || first.size() != 3 || count.size() != 3) return "no such array";
    const TiffSeries& series = series_[array];
    const std::vector<std::uint64_t>& shape = arrays_[array].shape;
    for (std::size_t i = 0; i < 3; ++i)
      if (first[i] > shape[i] || count[i] > shape[i] - first[i]) return "a box outside of the array";
    const std::uint64_t page_bytes = count[1] * count[2] * series.form.parts * size_of(series.form.type);
    if (to.size() != page_bytes * count[0]) return "a buffer of another size than the box";
    const TiffBox box{static_cast<std::uint32_t>(first[2]), static_cast<std::uint32_t>(first[1]),
                      static_cast<std::uint32_t>(count[2]), static_cast<std::uint32_t>(count[1])};
    for (std::uint64_t i = 0; i < count[0]; ++i) {
      const TiffPage& page = series.pages[first[0] + i];
      const std::span<std::byte> out = to.subspan(i * page_bytes, page_bytes);
      if (page.pixels) {
        if (!have_pixels(series, *page.pixels, box)) return "a page cannot be received";
        copy_pixels(series, *page.pixels, box, out);
        continue;
      }
      file_.forget_problem();
      if (current_ != page.directory) {
        current_ = 0;
        if (!TIFFSetSubDirectory(file_.get(), page.directory)) return file_.problem("a page cannot be read");
        current_ = page.directory;
      }
      // Selects the conversion of colours again, which is a state of the page.
      if (!(tiff_form_of(file_.get(), is_imagej_) == series.form)) return "a page changed";
      if (std::string problem = read_tiff_page(file_, series.form, box, out); !problem.empty()) return problem;
    }
    return {};
  }

 private:
  /// Receives the next directories at once if the last three are equally spaced, for a file on a server.
  void foresee_directories() {
    constexpr std::uint64_t kAhead = 64, kDirectoryBytes = 1024;
    const std::uint64_t here = TIFFCurrentDirOffset(file_.get()), size = file_.bytes().size();
    const std::uint64_t step = here - last_directories_[0];
    const bool even = here > last_directories_[0] && last_directories_[0] - last_directories_[1] == step;
    last_directories_ = {here, last_directories_[0]};
    if (!file_.need() || !even || here < foreseen_ || step < kDirectoryBytes) return;
    NeededParts needed(file_.need());
    for (std::uint64_t i = 1; i <= kAhead && here + i * step + kDirectoryBytes <= size; ++i)
      if (!needed.add(here + i * step, kDirectoryBytes)) return;
    (void)needed.finish();  // reading the directories reports problems
    foreseen_ = here + kAhead * step;
  }

  void add_page(double number) {
    TIFF* const tiff = file_.get();
    std::uint32_t kind = 0;
    TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
    if (number > 0 && (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0) return;
    const TiffForm form = tiff_form_of(tiff, is_imagej_);
    if (form.type == NumberType::none) return;
    auto series = std::ranges::find(series_, form, &TiffSeries::form);
    if (series == series_.end()) {
      constexpr std::size_t kMostSeries = 256, kMostText = std::size_t{16} << 20;
      if (series_.size() >= kMostSeries) return;
      TiffSeries made;
      made.form = form;
      made.description = text_field(tiff, TIFFTAG_IMAGEDESCRIPTION, kMostText);
      float x = 0, y = 0;
      std::uint16_t unit = RESUNIT_INCH;
      TIFFGetFieldDefaulted(tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
      if (TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x) && TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y))
        made.resolution = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(unit)};
      made.nodata = nodata_of(tiff);
      made.swapped = TIFFIsByteSwapped(tiff) != 0;
      series_.push_back(std::move(made));
      series = series_.end() - 1;
    }
    series->pages.push_back({TIFFCurrentDirOffset(tiff), std::nullopt});
    series->numbers.push_back(number);
  }

  static std::optional<double> nodata_of(TIFF* tiff) {
    constexpr std::uint32_t kGdalNoData = 42113;
    std::uint32_t count = 0;
    const char* text = nullptr;
    if (!TIFFFindField(tiff, kGdalNoData, TIFF_ASCII) || !TIFFGetField(tiff, kGdalNoData, &count, &text) || !text)
      return std::nullopt;
    const std::string_view all(text, strnlen(text, count));
    double value = 0;
    const auto read = std::from_chars(all.data(), all.data() + all.size(), value);
    return read.ec == std::errc() ? std::optional(value) : std::nullopt;
  }

  // Files of ImageJ above 4 GB have one directory; the pixels of all pages follow each other.
  void add_pages_of_imagej() {
    TiffSeries& series = series_.front();
    if (series_.size() != 1 || series.pages.size() != 1 || series.form.mode != TiffMode::stored || series.form.apart ||
        series.form.tiled || !std::string_view(series.description).starts_with("ImageJ="))
      return;
    const std::uint64_t images = number_after(series.description, "\nimages=");
    TIFF* const tiff = file_.get();
    std::uint16_t compression = COMPRESSION_NONE;
    if (images < 2 || !TIFFSetSubDirectory(tiff, series.pages.front().directory)) return;
    TIFFGetField(tiff, TIFFTAG_COMPRESSION, &compression);
    const std::uint64_t each =
        std::uint64_t{series.form.width} * series.form.height * series.form.samples * series.form.bits;
    const std::uint64_t begin = TIFFGetStrileOffset(tiff, 0), size = each / 8, all = file_.bytes().size();
    constexpr std::uint64_t kMostImages = 1'000'000;
    if (images > kMostImages || compression != COMPRESSION_NONE || each % 8 != 0 || series.form.bits % 8 != 0 ||
        size == 0 || begin == 0 || begin > all || images > (all - begin) / size ||
        series.form.bits / 8u != size_of(series.form.type))
      return;
    series.pages.clear();
    series.numbers.clear();
    for (std::uint64_t i = 0; i < images; ++i) {
      series.pages.push_back({0, begin + i * size});
      series.numbers.push_back(static_cast<double>(i));
    }
  }

  [[nodiscard]] bool have_pixels(const TiffSeries& series, std::uint64_t begin, const TiffBox& box) const {
    const std::uint64_t pixel = size_of(series.form.type) * series.form.parts, row = pixel * series.form.width;
    NeededParts needed(file_.need());
    for (std::uint32_t y = 0; y < box.height; ++y)
      if (!needed.add(begin + (std::uint64_t{box.y} + y) * row + box.x * pixel, box.width * pixel)) return false;
    return needed.finish();
  }

  void copy_pixels(const TiffSeries& series, std::uint64_t begin, const TiffBox& box, std::span<std::byte> to) const {
    const std::size_t size = size_of(series.form.type), pixel = size * series.form.parts;
    const auto bytes = file_.bytes();
    for (std::uint32_t y = 0; y < box.height; ++y)
      std::memcpy(to.data() + std::uint64_t{y} * box.width * pixel,
                  bytes.data() + begin + ((std::uint64_t{box.y} + y) * series.form.width + box.x) * pixel,
                  box.width * pixel);
    if (!series.swapped || size == 1) return;
    for (std::size_t at = 0; at + size <= to.size(); at += size) std::reverse(&to[at], &to[at] + size);
  }

  TiffHandle file_;
  bool is_imagej_ = false;
  std::uint64_t current_ = 0;  // page that was read last, or 0
  std::array<std::uint64_t, 2> last_directories_{};  // offsets, the last one first
  std::uint64_t foreseen_ = 0;                       // offset of the last directory that was received ahead
  std::vector<TiffSeries> series_;
  std::vector<ArrayInfo> arrays_;
  std::vector<std::string> groups_;
};

}  // namespace

ArrayFileResult open_tiff_arrays(ArrayBytes bytes, std::size_t) {
  auto file = std::make_shared<TiffArrays>(std::move(bytes));
  if (std::string problem = file->find_pages(); !problem.empty()) return problem;
  return file;
}

}  // namespace gs::app
