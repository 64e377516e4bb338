// Compares bytes with errors of pictures and of values of volumes: QNV (values, records) and zfp, gzip'd slices
// and JPEG XL slices.
//
//   volume_distortion VOLUME... [--pictures FOLDER] [--svg PLOT.svg] [--streams-alone]
//
// Prints two Markdown tables per volume. The first has for every budget PSNR (dB) and SSIM against pictures of the
// longest 9 % of the gradients from three sides, 800x600, headlight, drawn by render/volume. A budget of
// a QNV stream is a prefix of one stream. Other formats need their own file per budget, the best of several pyramid
// levels, steps and parts of the gradients. Needs zfp, cjxl and djxl (Debian: zfp, libjxl-tools) in the PATH; without
// them their columns are empty. The second table has the PSNR (dB) of the values over their range; coarser levels are
// interpolated.
// `--pictures` writes pictures of prefixes of 4, 15, 60 and 600 kB; `--svg` plots both tables of each volume.
#include "app/formats/volume/volume.h"
#include "bench/shared/curve_plot.h"
#include "bench/shared/curve_table.h"
#include "bench/shared/picture_error.h"
#include "qnv/codecs/payloads.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "render/scene/camera.h"
#include "render/volume/volume_raster.h"

#include <zlib.h>
#include <glm/trigonometric.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace gs;
using bench::PictureError;

constexpr std::array<std::size_t, 9> kBudgets{4000, 8000, 15'000, 32'000, 60'000, 125'000, 250'000, 600'000, 1'000'000};
constexpr std::array<std::array<float, 2>, 3> kViews{{{0, 0}, {120, -20}, {240, 30}}};
constexpr std::array<const char*, 5> kCodecs{"values", "records", "zfp", "gzip slices", "JPEG XL slices"};
constexpr std::size_t kValues = 0, kRecords = 1, kZfp = 2, kGzip = 3, kJxl = 4;
constexpr double kFraction = 0.09;

/// Values of a volume in memory.
struct Grid {
  qnv::VolumeLayout layout;
  std::vector<float> values;

  [[nodiscard]] qnv::VolumeSource source() const {
    qnv::VolumeSource source{layout, {}};
    source.layout.type = qnv::VoxelType::f32;
    source.layout.big_endian = false;
    source.layout.slope = 1;
    source.layout.intercept = 0;
    source.layout.missing.reset();
    source.read = [this](std::uint32_t z, std::span<std::byte> slice) {
      std::memcpy(slice.data(), reinterpret_cast<const std::byte*>(values.data()) + z * slice.size(), slice.size());
      return true;
    };
    return source;
  }
  [[nodiscard]] std::pair<float, float> range() const {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return {*least, *most};
  }
};

Grid read_grid(const qnv::VolumeSource& source) {
  Grid grid{source.layout, std::vector<float>(qnv::voxel_count(source.layout))};
  std::vector<std::byte> scratch;
  const std::size_t slice = qnv::slice_voxels(source.layout);
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z)
    (void)qnv::read_slice(source, z, scratch, std::span(grid.values).subspan(z * slice, slice));
  for (float& value : grid.values) value = value == value ? value : 0;
  return grid;
}

/// Returns a grid of half the resolution: each voxel is the mean of two voxels along each axis.
Grid halved(const Grid& fine) {
  Grid grid{fine.layout, {}};
  const auto& n = fine.layout.dimensions;
  std::array<std::uint32_t, 3> m{};
  for (std::size_t i = 0; i < 3; ++i) {
    m[i] = (n[i] + 1) / 2;
    grid.layout.axes[i] = fine.layout.axes[i] * 2.0f;
    grid.layout.origin += fine.layout.axes[i] * 0.5f;
  }
  grid.layout.dimensions = m;
  for (std::uint32_t z = 0; z < m[2]; ++z)
    for (std::uint32_t y = 0; y < m[1]; ++y)
      for (std::uint32_t x = 0; x < m[0]; ++x) {
        float sum = 0;
        for (unsigned c = 0; c < 8; ++c) {
          const std::size_t a = std::min(2 * x + (c & 1), n[0] - 1), b = std::min(2 * y + (c >> 1 & 1), n[1] - 1),
                            d = std::min(2 * z + (c >> 2), n[2] - 1);
          sum += fine.values[(d * n[1] + b) * n[0] + a];
        }
        grid.values.push_back(sum / 8);
      }
  return grid;
}

/// Returns the value of a grid at a position in units of its voxels, interpolated and clamped to the grid.
double interpolated(const Grid& grid, std::array<double, 3> at) {
  const auto& n = grid.layout.dimensions;
  std::array<std::size_t, 3> low{}, high{};
  std::array<double, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    at[a] = std::clamp(at[a], 0.0, n[a] - 1.0);
    low[a] = static_cast<std::size_t>(at[a]);
    high[a] = std::min<std::size_t>(low[a] + 1, n[a] - 1);
    part[a] = at[a] - static_cast<double>(low[a]);
  }
  double sum = 0;
  for (unsigned c = 0; c < 8; ++c) {
    double weight = 1;
    std::array<std::size_t, 3> corner{};
    for (std::size_t a = 0; a < 3; ++a) {
      const bool upper = (c >> a & 1) != 0;
      corner[a] = upper ? high[a] : low[a];
      weight *= upper ? part[a] : 1 - part[a];
    }
    sum += weight * static_cast<double>(grid.values[(corner[2] * n[1] + corner[1]) * n[0] + corner[0]]);
  }
  return sum;
}

/// Returns the PSNR of the values of a grid. Its voxels are `step` voxels of the original apart, and the first one is
/// at `offset`.
double value_psnr(const Grid& original, const Grid& grid, double step, double offset) {
  const auto& n = original.layout.dimensions;
  const auto [least, most] = original.range();
  double sum = 0;
  std::size_t i = 0;
  for (std::size_t z = 0; z < n[2]; ++z)
    for (std::size_t y = 0; y < n[1]; ++y)
      for (std::size_t x = 0; x < n[0]; ++x, ++i) {
        const auto place = [&](std::size_t v) { return (static_cast<double>(v) - offset) / step; };
        const double value = step == 1 && offset == 0 ? static_cast<double>(grid.values[i])
                                                      : interpolated(grid, {place(x), place(y), place(z)});
        sum += std::pow(value - static_cast<double>(original.values[i]), 2);
      }
  const double range = static_cast<double>(most) - static_cast<double>(least);
  return sum > 0 ? 10 * std::log10(range * range * static_cast<double>(i) / sum) : 99;
}

qnv::Volume volume_of(const qnv::StreamDecoder& decoder) {
  const qnv::Geometry geometry = decoder.geometry();
  const auto* volume = geometry.as<qnv::Volume>();
  return volume ? *volume : qnv::Volume();
}

class Painter {
 public:
  explicit Painter(const qnv::Volume& all) : about_(all.description) { reference_ = pictures(all); }

  [[nodiscard]] std::vector<render::Image> pictures(const qnv::Volume& volume) const {
    std::vector<render::Image> out;
    const render::VolumeModel model = render::volume_model(volume);
    const Box bounds{about_.box.lower, about_.box.upper};
    for (const auto& [azimuth, elevation] : kViews) {
      constexpr float kFieldOfView = 0.785398f;
      const render::Camera camera = render::fit_depth(
          render::orbit_camera(bounds, glm::radians(azimuth), glm::radians(elevation), kFieldOfView, kWidth, kHeight),
          bounds);
      render::SplatView view;
      view.camera_from_node = glm::mat4(render::camera_from_world_of(camera));
      view.width = kWidth;
      view.height = kHeight;
      view.near_plane = camera.near_plane;
      const float tangent = std::tan(kFieldOfView / 2);
      view.tangents = {tangent * kWidth / kHeight, tangent};
      const render::VolumeItem item{&volume, &model, view.camera_from_node, model.spacing.size(), {}};
      const render::VolumeLayer layer = render::rasterize_volumes(std::span(&item, 1), view);
      render::Image image;
      image.width = kWidth;
      image.height = kHeight;
      image.components = 3;
      image.pixels.assign(std::size_t{kWidth} * kHeight * 3, 0);
      for (std::size_t y = 0; y < kHeight && !layer.empty(); ++y)
        for (std::size_t x = 0; x < kWidth; ++x)
          for (std::size_t k = 0; k < 3; ++k)
            image.pixels[((kHeight - 1 - y) * kWidth + x) * 3 + k] = layer.pixels[(y * kWidth + x) * 4 + k];
      out.push_back(std::move(image));
    }
    return out;
  }
  [[nodiscard]] PictureError error(const qnv::Volume& volume) const {
    return bench::picture_error(pictures(volume), reference_);
  }
  /// Returns the smallest error over several parts of a grid's gradients, in the colours of the reference.
  [[nodiscard]] PictureError error(const Grid& grid) const {
    PictureError best;
    for (const double fraction : {kFraction, 0.15, 0.22}) {
      qnv::GradientOptions options;
      options.fraction = fraction;
      const auto found = qnv::gradient_vectors(grid.source(), options);
      const auto* volume = std::get_if<qnv::Volume>(&found);
      if (!volume || volume->empty()) continue;
      qnv::Volume drawn = *volume;
      const auto [least, most] = volume->description.value_range;
      const auto [from, to] = about_.value_range;
      for (std::uint8_t& c : drawn.classes) {
        const float value = least + static_cast<float>(c) / 255 * (most - least);
        c = static_cast<std::uint8_t>(std::clamp((value - from) / (to - from) * 255 + 0.5f, 0.0f, 255.0f));
      }
      drawn.description.transfer = about_.transfer;
      drawn.description.value_range = about_.value_range;
      const PictureError one = error(drawn);
      if (one.psnr > best.psnr) best = one;
      if (grid.values.size() > 4'000'000) break;  // larger grids would equal the reference
    }
    return best;
  }

 private:
  static constexpr int kWidth = 800, kHeight = 600;
  qnv::Description about_;
  std::vector<render::Image> reference_;
};

struct Measured {
  std::size_t bytes = 0;
  PictureError error;
};
using Curve = std::map<std::size_t, Measured>;  // by budget

void keep_best(Curve& curve, std::size_t bytes, const PictureError& error) {
  for (const std::size_t budget : kBudgets)
    if (bytes <= budget && (!curve.contains(budget) || error.psnr > curve[budget].error.psnr))
      curve[budget] = {bytes, error};
}
/// PSNR of values by budget.
using ValueCurve = std::map<std::size_t, double>;
void keep_best(ValueCurve& curve, std::size_t bytes, double psnr) {
  for (const std::size_t budget : kBudgets)
    if (bytes <= budget) curve[budget] = std::max(curve[budget], psnr);
}

/// Grid to encode, a level of the original.
struct LevelGrid {
  const Grid& original;
  Grid grid;
  int level = 0;
  [[nodiscard]] double psnr(const Grid& decoded) const {
    const double step = std::ldexp(1.0, level);
    return value_psnr(original, decoded, step, (step - 1) / 2);
  }
};

bool of_use(std::size_t bytes) { return bytes <= kBudgets.back(); }

void write(const std::string& path, const void* data, std::size_t bytes) {
  std::ofstream(path, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
}
std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
bool run(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

// Measures zfp. `tolerance` is relative to the range.
void measure_zfp(const Painter& painter, const LevelGrid& level, const std::string& base, double tolerance,
                 Curve& curve, ValueCurve& values) {
  const Grid& grid = level.grid;
  const auto [least, most] = grid.range();
  const auto& n = grid.layout.dimensions;
  char shape[160];
  std::snprintf(shape, sizeof shape, " -f -3 %u %u %u -a %.9g", n[0], n[1], n[2],
                tolerance * static_cast<double>(most - least));
  write(base + ".f32", grid.values.data(), grid.values.size() * sizeof(float));
  if (!run("zfp -i " + base + ".f32 -z " + base + ".zfp -o " + base + ".out" + shape)) return;
  const std::size_t bytes = std::filesystem::file_size(base + ".zfp");
  if (!of_use(bytes)) return;
  Grid back{grid.layout, grid.values};
  const std::string text = read(base + ".out");
  if (text.size() != back.values.size() * sizeof(float)) return;
  std::memcpy(back.values.data(), text.data(), text.size());
  keep_best(curve, bytes, painter.error(back));
  keep_best(values, bytes, level.psnr(back));
}

// Measures deflated slices. Uses values or differences to the previous value, whichever is smaller.
void measure_gzip(const Painter& painter, const Grid& grid, int values, Curve& curve) {
  const auto [least, most] = grid.range();
  const float step = (most - least) / static_cast<float>(values - 1);
  std::vector<unsigned char> plain, steps;
  Grid back{grid.layout, {}};
  for (const float value : grid.values) {
    const float code = std::round((value - least) / step);
    back.values.push_back(least + code * step);
    steps.push_back(static_cast<unsigned char>(static_cast<int>(code) - (plain.empty() ? 0 : plain.back())));
    plain.push_back(static_cast<unsigned char>(code));
  }
  std::size_t bytes = ~std::size_t{0};
  for (const auto* content : {&plain, &steps}) {
    uLongf size = compressBound(content->size());
    std::vector<unsigned char> out(size);
    if (compress2(out.data(), &size, content->data(), content->size(), 9) == Z_OK)
      bytes = std::min<std::size_t>(bytes, size);
  }
  if (of_use(bytes)) keep_best(curve, bytes, painter.error(back));
}

// Measures JPEG XL: all slices side by side in one grey image with 8 bits per pixel.
void measure_jxl(const Painter& painter, const LevelGrid& level, const std::string& base, double distance, Curve& curve,
                 ValueCurve& values) {
  const Grid& grid = level.grid;
  const auto [least, most] = grid.range();
  const auto& n = grid.layout.dimensions;
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(n[2]))));
  const std::uint32_t rows = (n[2] + columns - 1) / columns;
  const std::size_t width = std::size_t{columns} * n[0], height = std::size_t{rows} * n[1];
  std::vector<unsigned char> pixels(width * height);
  const auto pixel = [&](std::size_t x, std::size_t y, std::size_t z) -> unsigned char& {
    return pixels[(z / columns * n[1] + y) * width + z % columns * n[0] + x];
  };
  const auto each = [&](auto&& work) {
    std::size_t i = 0;
    for (std::size_t z = 0; z < n[2]; ++z)
      for (std::size_t y = 0; y < n[1]; ++y)
        for (std::size_t x = 0; x < n[0]; ++x) work(i++, pixel(x, y, z));
  };
  each([&](std::size_t i, unsigned char& p) {
    p = static_cast<unsigned char>((grid.values[i] - least) / (most - least) * 255 + 0.5f);
  });
  const std::string head = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
  std::string file = head + std::string(pixels.begin(), pixels.end());
  write(base + ".pgm", file.data(), file.size());
  char how[64];
  std::snprintf(how, sizeof how, " -d %g --num_threads=1", distance);
  if (!run("cjxl " + base + ".pgm " + base + ".jxl" + how)) return;
  const std::size_t bytes = std::filesystem::file_size(base + ".jxl");
  if (!of_use(bytes) || !run("djxl " + base + ".jxl " + base + ".out.pgm")) return;
  file = read(base + ".out.pgm");
  if (file.size() < pixels.size()) return;
  std::copy(file.end() - static_cast<std::ptrdiff_t>(pixels.size()), file.end(), pixels.begin());
  Grid back{grid.layout, grid.values};
  each([&](std::size_t i, unsigned char& p) { back.values[i] = least + static_cast<float>(p) / 255 * (most - least); });
  keep_best(curve, bytes, painter.error(back));
  keep_best(values, bytes, level.psnr(back));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure_stream(const Painter& painter, std::span<const std::byte> stream, Curve& curve) {
  for (const std::size_t budget : kBudgets) {
    qnv::StreamDecoder decoder;
    (void)decoder.push(stream.first(std::min(budget, stream.size())));
    curve[budget] = {std::min(budget, stream.size()), painter.error(volume_of(decoder))};
  }
}

/// Measures the values of prefixes of a values stream.
void measure_values(const Grid& original, std::span<const std::byte> stream, ValueCurve& curve) {
  for (const std::size_t budget : kBudgets) {
    qnv::StreamDecoder decoder;
    (void)decoder.push(stream.first(std::min(budget, stream.size())));
    const qnv::Volume volume = volume_of(decoder);
    if (!volume.values) continue;
    const Grid grid = read_grid(volume.values->source);
    curve[budget] = value_psnr(original, grid, std::ldexp(1.0, volume.values->level), 0);
  }
}

void print_values(const ValueCurve& values, const ValueCurve& zfp, const ValueCurve& jxl) {
  std::printf("| bytes | values | zfp | JPEG XL slices |\n| ---: | ---: | ---: | ---: |\n");
  for (const std::size_t budget : kBudgets) {
    std::printf("| %zu |", budget);
    for (const ValueCurve* curve : {&values, &zfp, &jxl})
      if (const auto found = curve->find(budget); found != curve->end() && found->second > 0)
        std::printf(" %.1f |", found->second);
      else
        std::printf(" |");
    std::printf("\n");
  }
}

/// Adds the diagrams of a volume: pictures and values.
void plot(const std::string& name, const std::array<Curve, kCodecs.size()>& curves, const ValueCurve& values,
          const ValueCurve& zfp, const ValueCurve& jxl, std::vector<bench::PlotPanel>& panels) {
  bench::PlotPanel& pictures = panels.emplace_back(bench::PlotPanel{name + ", pictures", {}});
  for (const Curve& curve : curves)
    for (auto& plotted = pictures.curves.emplace_back(); const auto& [budget, measured] : curve)
      plotted[budget] = measured.error.psnr;
  panels.push_back({name + ", values", {values, {}, zfp, {}, jxl}});  // in the order of kCodecs
}

bool measure(const std::string& path, const std::string& folder, bool others, std::vector<bench::PlotPanel>& panels) {
  const auto opened = app::open_volume(path);
  const auto* source = std::get_if<qnv::VolumeSource>(&opened);
  if (!source) return false;
  const Grid grid = read_grid(*source);
  qnv::GradientOptions gradients;
  gradients.fraction = kFraction;
  const auto found = qnv::gradient_vectors(*source, gradients);
  const auto* volume = std::get_if<qnv::Volume>(&found);
  if (!volume) return false;
  const auto records = qnv::row_of(qnv::Payload::records).encode(qnv::VectorView(*volume), {}, nullptr);
  const auto start = std::chrono::steady_clock::now();
  const auto values = qnv::row_of(qnv::Payload::values).encode(std::cref(*source), {}, nullptr);
  const double encoding = seconds_since(start);
  const auto* stream = std::get_if<qnv::EncodedStream>(&values);
  const auto* other = std::get_if<qnv::EncodedStream>(&records);
  if (!stream || !other) return false;
  const Painter painter(*volume);
  const std::string name = std::filesystem::path(path).filename().string();
  const auto voxels = static_cast<double>(grid.values.size());
  std::printf(
      "### %s (%zu vectors)\n\nvalues %zu bytes, %.2f bits a voxel, encoding %.2f s: %.1f M voxels/s; records %zu "
      "bytes.\n\n",
      name.c_str(), volume->size(), stream->bytes.size(), 8 * static_cast<double>(stream->bytes.size()) / voxels,
      encoding, voxels / encoding / 1e6, other->bytes.size());
  std::fflush(stdout);
  std::array<Curve, kCodecs.size()> curves;
  ValueCurve of_stream, of_zfp, of_jxl;
  measure_stream(painter, stream->bytes, curves[kValues]);
  measure_values(grid, stream->bytes, of_stream);
  measure_stream(painter, other->bytes, curves[kRecords]);
  const std::string base =
      (std::filesystem::temp_directory_path() / ("volume_distortion." + std::to_string(getpid()))).string();
  LevelGrid level{grid, grid, 0};
  if (!others) level.grid.values.clear();
  for (; level.level < 5 && level.grid.values.size() > 500; ++level.level, level.grid = halved(level.grid)) {
    for (const double tolerance : {0.5, 0.2, 0.08, 0.03, 0.01})
      measure_zfp(painter, level, base, tolerance, curves[kZfp], of_zfp);
    for (const int steps : {256, 48, 12, 5}) measure_gzip(painter, level.grid, steps, curves[kGzip]);
    for (const double distance : {25.0, 12.0, 6.0, 2.5, 1.0})
      measure_jxl(painter, level, base, distance, curves[kJxl], of_jxl);
  }
  for (const char* ending : {".f32", ".zfp", ".out", ".pgm", ".jxl", ".out.pgm"})
    std::filesystem::remove(base + ending);
  bench::print_curve_table(kCodecs, kBudgets, curves);
  std::printf("\n");
  print_values(of_stream, of_zfp, of_jxl);
  plot(name, curves, of_stream, of_zfp, of_jxl, panels);
  std::printf("\n");
  std::fflush(stdout);
  if (folder.empty()) return true;
  for (const std::size_t bytes : {4000, 15'000, 60'000, 600'000}) {
    qnv::StreamDecoder part;
    (void)part.push(std::span(stream->bytes).first(std::min<std::size_t>(bytes, stream->bytes.size())));
    const auto pictures = painter.pictures(volume_of(part));
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const std::string to = folder + "/" + name + "." + std::to_string(bytes) + "." + std::to_string(i) + ".ppm";
      std::ofstream out(to, std::ios::binary);
      out << "P6\n" << pictures[i].width << ' ' << pictures[i].height << "\n255\n";
      out.write(reinterpret_cast<const char*>(pictures[i].pixels.data()),
                static_cast<std::streamsize>(pictures[i].pixels.size()));
    }
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> files;
  std::string folder, svg;
  bool others = true;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--pictures" && i + 1 < count)
      folder = arguments[++i];
    else if (std::string(arguments[i]) == "--svg" && i + 1 < count)
      svg = arguments[++i];
    else if (std::string(arguments[i]) == "--streams-alone")
      others = false;
    else
      files.emplace_back(arguments[i]);
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: volume_distortion VOLUME... [--pictures FOLDER] [--svg PLOT.svg] [--streams-alone]\n");
    return 2;
  }
  std::vector<bench::PlotPanel> panels;
  for (const std::string& file : files)
    if (!measure(file, folder, others, panels)) {
      std::fprintf(stderr, "volume_distortion: %s cannot be measured\n", file.c_str());
      return 1;
    }
  if (svg.empty()) return 0;
  constexpr std::array<const char*, kCodecs.size()> kColors{"#009944", "#66a3e0", "#cc3300", "#999999", "#0066cc"};
  std::vector<bench::PlotCodec> codecs;
  for (std::size_t c = 0; c < kCodecs.size(); ++c) codecs.push_back({kCodecs[c], kColors[c]});
  bench::write_plot(svg, codecs, panels, {15, 70});
  return 0;
}
