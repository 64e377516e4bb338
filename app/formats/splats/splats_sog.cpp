#include "app/formats/splats/splats_sog.h"

#include "app/formats/archive/zip_archive.h"
#include "app/formats/splats/splats.h"

#include <webp/decode.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

using Json = nlohmann::json;
using Problem = std::optional<std::string>;

constexpr std::size_t kMostMeta = std::size_t{4} << 20;  // bytes of meta.json
constexpr std::size_t kCodebook = 256, kCentroidsPerRow = 64;
constexpr std::string_view kMeta = "meta.json";

/// Decoded image, four bytes a pixel, rows from the top.
struct Pixels {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  Share share;

  [[nodiscard]] const std::uint8_t* at(std::size_t i) const { return rgba.data() + 4 * i; }
  [[nodiscard]] std::size_t count() const { return width * height; }
};

/// Decodes an image of a SOG.
std::variant<Pixels, std::string> decoded_image(const std::string& name, const ReadFile& read,
                                                const WorldBudget& budget) {
  if (!read) return name + " is not available";
  BytesResult result = read(name);
  if (auto* problem = std::get_if<std::string>(&result)) return std::move(*problem);
  const SharedBytes file = std::get<SharedBytes>(std::move(result));
  const auto* const data = reinterpret_cast<const std::uint8_t*>(file.bytes.data());
  int width = 0, height = 0;
  if (!WebPGetInfo(data, file.bytes.size(), &width, &height)) return name + " is not a WebP image";
  Pixels pixels;
  pixels.width = static_cast<std::size_t>(width);
  pixels.height = static_cast<std::size_t>(height);
  pixels.share = Share(budget, Resource::files);
  if (!pixels.share.grow(4 * pixels.count())) return name + " needs " + budget->refusal(Resource::files);
  pixels.rgba.resize(4 * pixels.count());
  if (!WebPDecodeRGBAInto(data, file.bytes.size(), pixels.rgba.data(), pixels.rgba.size(), 4 * width))
    return name + " is damaged";
  return pixels;
}

/// Reads a list of `count` finite numbers.
std::optional<std::vector<float>> sog_numbers(const Json& from, const char* key, std::size_t count) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_array() || found->size() < count) return std::nullopt;
  std::vector<float> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    numbers.push_back((*found)[i].get<float>());
    if (!std::isfinite(numbers.back())) return std::nullopt;
  }
  return numbers;
}

/// Returns true for the name of a file in the folder of meta.json.
bool is_file_beside(const std::string& name) {
  return !name.empty() && name.find_first_of("/\\:?#%") == std::string::npos && name != "..";
}

const Json& member(const Json& from, const char* key) {
  static const Json none = Json::object();
  const auto found = from.find(key);
  return found != from.end() && found->is_object() ? *found : none;
}

/// Reader of one SOG, version 1 or 2.
class SogReader {
 public:
  SogReader(const Json& meta, const ReadFile& read) : meta_(meta), read_(read) {}

  Problem read(SplatModel& model, const WorldBudget& budget) {
    budget_ = budget;
    version_ = meta_.value("version", Json()).is_number() ? meta_["version"].get<int>() : 1;
    if (version_ < 1 || version_ > 2) return "SOG version " + std::to_string(version_) + "; expected 1 or 2";
    if (auto problem = find_count()) return problem;
    for (const auto& [key, name, at] :
         {std::tuple{"means", "low bytes of the positions", &low_}, std::tuple{"scales", "scales", &scales_},
          std::tuple{"quats", "rotations", &rotations_}, std::tuple{"sh0", "colours", &colors_}})
      if (auto problem = load(key, 0, name, *at)) return problem;
    if (auto problem = load("means", 1, "high bytes of the positions", high_)) return problem;
    if (auto problem = find_harmonics()) return problem;
    model.format = version_ == 2 ? "SOG" : "SOG, version 1";
    model.announced = count_;
    model.set_degree(degree_);
    if (auto problem = model.draw(budget, count_)) return problem;
    model.resize(count_);
    const auto kind = meta_.find("model");
    model.antialiased = (kind != meta_.end() && *kind == "antialiased") || meta_.value("antialias", Json()) == true;
    const bool flat = kind != meta_.end() && *kind == "2dgs";
    if (auto problem = read_positions(model)) return problem;
    if (auto problem = read_shapes(model, flat)) return problem;
    if (auto problem = read_colors(model)) return problem;
    read_harmonics(model);
    return std::nullopt;
  }

 private:
  Problem find_count() {
    const Json& shape = member(meta_, "means");
    std::uint64_t count = 0;
    if (version_ == 2 && meta_.contains("count") && meta_["count"].is_number_unsigned())
      count = meta_["count"].get<std::uint64_t>();
    else if (const auto found = shape.find("shape");
             found != shape.end() && found->is_array() && !found->empty() && (*found)[0].is_number_unsigned())
      count = (*found)[0].get<std::uint64_t>();
    constexpr std::uint64_t kMost = std::uint64_t{16383} * 16383;  // pixels of a WebP image
    if (count == 0 || count > kMost) return "meta.json has no valid number of splats";
    count_ = static_cast<std::size_t>(count);
    return std::nullopt;
  }

  /// Decodes an image with one pixel per splat.
  Problem load(const char* key, std::size_t number, const char* content, Pixels& to, bool per_splat = true) {
    const auto files = member(meta_, key).find("files");
    const Json& described = member(meta_, key);
    if (files == described.end() || !files->is_array() || files->size() <= number || !(*files)[number].is_string())
      return std::string("meta.json names no file of the ") + content;
    const std::string name = (*files)[number].get<std::string>();
    if (!is_file_beside(name)) return "meta.json names a file in another folder: " + name;
    auto image = decoded_image(name, read_, budget_);
    if (auto* problem = std::get_if<std::string>(&image)) return std::move(*problem);
    to = std::move(std::get<Pixels>(image));
    if (per_splat && to.count() < count_)
      return name + " has " + std::to_string(to.count()) + " pixels; expected one for each of " +
             std::to_string(count_) + " splats";
    return std::nullopt;
  }

  Problem find_harmonics() {
    const Json& described = member(meta_, "shN");
    if (described.empty()) return std::nullopt;
    if (auto problem = load("shN", 0, "harmonics", centroids_, false)) return problem;
    if (auto problem = load("shN", 1, "labels of harmonics", labels_)) return problem;
    for (int degree = 1; degree <= 3; ++degree)
      if (centroids_.width == kCentroidsPerRow * qnv::harmonic_count(degree)) degree_ = degree;
    if (degree_ == 0)
      return "the palette of harmonics is " + std::to_string(centroids_.width) +
             " pixels wide; expected 192, 512 or 960";
    if (version_ == 2) {
      const auto codebook = sog_numbers(described, "codebook", kCodebook);
      if (!codebook) return "meta.json has no codebook of harmonics with 256 numbers";
      std::ranges::copy(*codebook, harmonic_values_.begin());
    } else {
      const auto number = [&](const char* key) {
        const auto found = described.find(key);
        return found != described.end() && found->is_number() ? found->get<float>() : NAN;
      };
      const float least = number("mins"), most = number("maxs");
      if (!std::isfinite(least) || !std::isfinite(most)) return "meta.json has no range of harmonics";
      for (std::size_t u = 0; u < kCodebook; ++u)
        harmonic_values_[u] = least + (most - least) * static_cast<float>(u) / 255;
    }
    return std::nullopt;
  }

  Problem read_positions(SplatModel& model) const {
    const auto least = sog_numbers(member(meta_, "means"), "mins", 3),
               most = sog_numbers(member(meta_, "means"), "maxs", 3);
    if (!least || !most) return "meta.json has no range of the positions";
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double q = low_.at(i)[k] + 256.0 * high_.at(i)[k];
        const double v = static_cast<double>((*least)[k]) +
                         (static_cast<double>((*most)[k]) - static_cast<double>((*least)[k])) * q / 65535;
        model.positions[i][static_cast<int>(k)] = std::copysign(std::expm1(std::abs(v)), v);
      }
    return std::nullopt;
  }

  /// Returns the numbers that the bytes of a channel stand for.
  std::optional<std::array<std::array<float, kCodebook>, 4>> values_of(const char* key, std::size_t channels) const {
    std::array<std::array<float, kCodebook>, 4> values{};
    const Json& described = member(meta_, key);
    if (version_ == 2) {
      const auto codebook = sog_numbers(described, "codebook", kCodebook);
      if (!codebook) return std::nullopt;
      for (auto& channel : values) std::ranges::copy(*codebook, channel.begin());
      return values;
    }
    const auto least = sog_numbers(described, "mins", channels), most = sog_numbers(described, "maxs", channels);
    if (!least || !most) return std::nullopt;
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t u = 0; u < kCodebook; ++u)
        values[c][u] = (*least)[c] + ((*most)[c] - (*least)[c]) * static_cast<float>(u) / 255;
    return values;
  }

  Problem read_shapes(SplatModel& model, bool flat) const {
    const auto values = values_of("scales", 3);
    if (!values) return "meta.json has no numbers of the scales";
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        model.scales[i][static_cast<int>(k)] = flat && k == 2 ? 0.0f : std::exp((*values)[k][scales_.at(i)[k]]);
      // The largest component of w, x, y, z is left out; alpha names it.
      const std::uint8_t* const from = rotations_.at(i);
      if (from[3] < 252) {
        model.rotations[i] = {0, 0, 0, 1};
        continue;
      }
      const std::size_t largest = from[3] - 252u;
      std::array<float, 4> wxyz{};
      float rest = 1;
      for (std::size_t k = 0, next = 0; k < 4; ++k) {
        if (k == largest) continue;
        wxyz[k] = (static_cast<float>(from[next++]) / 255 - 0.5f) * std::numbers::sqrt2_v<float>;
        rest -= wxyz[k] * wxyz[k];
      }
      wxyz[largest] = std::sqrt(std::max(rest, 0.0f));
      model.rotations[i] = {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
    }
    return std::nullopt;
  }

  Problem read_colors(SplatModel& model) const {
    const auto values = values_of("sh0", 4);
    if (!values) return "meta.json has no numbers of the colours";
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint8_t* const from = colors_.at(i);
      for (std::size_t k = 0; k < 3; ++k) model.dc[i][static_cast<int>(k)] = (*values)[k][from[k]];
      // Version 1 stores log odds.
      model.opacities[i] =
          version_ == 2 ? static_cast<float>(from[3]) / 255 : 1 / (1 + std::exp(-(*values)[3][from[3]]));
    }
    return std::nullopt;
  }

  void read_harmonics(SplatModel& model) const {
    const std::size_t per = qnv::harmonic_count(degree_);
    for (std::size_t i = 0; i < count_ && per > 0; ++i) {
      const std::size_t label = labels_.at(i)[0] + 256u * labels_.at(i)[1];
      const std::size_t row = label / kCentroidsPerRow, column = label % kCentroidsPerRow * per;
      if (row >= centroids_.height) continue;
      for (std::size_t k = 0; k < per; ++k) {
        const std::uint8_t* const from = centroids_.at(row * centroids_.width + column + k);
        model.coefficient(i, k) = {harmonic_values_[from[0]], harmonic_values_[from[1]], harmonic_values_[from[2]]};
      }
    }
  }

  const Json& meta_;
  const ReadFile& read_;
  WorldBudget budget_;
  int version_ = 1, degree_ = 0;
  std::size_t count_ = 0;
  Pixels low_, high_, scales_, rotations_, colors_, centroids_, labels_;
  std::array<float, kCodebook> harmonic_values_{};
};

std::variant<qnv::Splats, qnv::Gaussians, std::string> import_sog(const ImportSource& source) {
  SplatModel model;
  if (!is_zip(source.bytes)) {
    if (auto problem = read_sog_model(source.bytes, source.read_file, source.budget, model)) return std::move(*problem);
    return import_result(model);
  }
  auto opened = ZipArchive::open(source.bytes);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const ZipArchive& archive = std::get<ZipArchive>(opened);
  const ReadFile read = [&](const std::string& name) -> BytesResult {
    auto unpacked = archive.read(name, source.budget);
    if (auto* problem = std::get_if<std::string>(&unpacked)) return std::move(*problem);
    return shared_bytes(std::move(std::get<std::vector<std::byte>>(unpacked)));
  };
  const BytesResult meta = read(std::string(kMeta));
  if (const auto* problem = std::get_if<std::string>(&meta)) return *problem;
  if (auto problem = read_sog_model(std::get<SharedBytes>(meta).bytes, read, source.budget, model))
    return std::move(*problem);
  return import_result(model);
}

}  // namespace

std::vector<std::string> sog_files_of(std::span<const std::byte> text) {
  std::vector<std::string> names;
  if (text.size() > kMostMeta) return names;
  const auto* const characters = reinterpret_cast<const char*>(text.data());
  const Json meta = Json::parse(characters, characters + text.size(), nullptr, false);
  if (!meta.is_object()) return names;
  for (const char* key : {"means", "scales", "quats", "sh0", "shN"}) {
    const Json& described = member(meta, key);
    const auto files = described.find("files");
    if (files == described.end() || !files->is_array() || files->size() > 2) continue;
    for (const Json& file : *files)
      if (file.is_string() && is_file_beside(file.get<std::string>())) names.push_back(file.get<std::string>());
  }
  return names;
}

std::optional<std::string> read_sog_model(std::span<const std::byte> text, const ReadFile& read,
                                          const WorldBudget& budget, SplatModel& model) {
  if (text.size() > kMostMeta) return "meta.json has " + std::to_string(text.size()) + " bytes; expected at most 4 MiB";
  const auto* const characters = reinterpret_cast<const char*>(text.data());
  const Json meta = Json::parse(characters, characters + text.size(), nullptr, false);
  if (!meta.is_object()) return "meta.json is not a JSON object";
  return SogReader(meta, read).read(model, budget);
}

bool is_splats_sog(std::span<const std::byte> bytes) {
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view name = first_name_in_zip(bytes), text = all.substr(0, 4096);
  if (name.ends_with(kMeta) || name.find("means_") != std::string_view::npos) return !name.ends_with("lod-meta.json");
  return text.starts_with('{') && text.find("\"means\"") != std::string_view::npos &&
         text.find("means_l.webp") != std::string_view::npos;
}

Asset read_splats_sog(const ImportSource& source) {
  auto imported = import_sog(source);
  if (auto* splats = std::get_if<qnv::Splats>(&imported)) return std::move(*splats);
  if (auto* splats = std::get_if<qnv::Gaussians>(&imported)) return std::move(*splats);
  source.diagnostics.add({Severity::error, source.path, {}, std::get<std::string>(imported)});
  return {};
}

}  // namespace gs::app
