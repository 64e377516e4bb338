#include "app/view/values/color_maps.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gs::app {
namespace {

constexpr std::size_t kMapPoints = 17;  // points of a transfer function that is made from a map
constexpr float kMaxMapOpacity = 0.9f;

template <std::size_t count>
glm::vec3 polynomial(const std::array<glm::vec3, count>& coefficients, float place) {
  glm::vec3 sum(0);
  for (std::size_t i = count; i-- > 0;) sum = sum * place + coefficients[i];
  return glm::clamp(sum, 0.0f, 1.0f);
}

glm::vec3 grey_color(float place) { return glm::vec3(place); }

// Polynomials of degree 6 by M. Zucker (CC0). They approximate the maps of S. van der Walt and N. Smith in matplotlib
// (CC0).
constexpr std::array<glm::vec3, 7> kViridis{{{0.2777273f, 0.0054073f, 0.3340998f},
                                             {0.1050930f, 1.4046135f, 1.3845902f},
                                             {-0.3308618f, 0.2148476f, 0.0950952f},
                                             {-4.6342305f, -5.7991010f, -19.3324410f},
                                             {6.2282699f, 14.1799334f, 56.6905526f},
                                             {4.7763850f, -13.7451454f, -65.3530326f},
                                             {-5.4354559f, 4.6458526f, 26.3124352f}}};
constexpr std::array<glm::vec3, 7> kInferno{{{0.0002189f, 0.0016510f, -0.0194809f},
                                             {0.1065134f, 0.5639564f, 3.9327124f},
                                             {11.6024931f, -3.9728540f, -15.9423941f},
                                             {-41.7039961f, 17.4363989f, 44.3541452f},
                                             {77.1629357f, -33.4023589f, -81.8073093f},
                                             {-71.3194282f, 32.6260643f, 73.2095199f},
                                             {25.1311262f, -12.2426690f, -23.0703250f}}};
constexpr std::array<glm::vec3, 7> kMagma{{{-0.0021365f, -0.0007497f, -0.0053861f},
                                           {0.2516605f, 0.6775232f, 2.4940266f},
                                           {8.3537173f, -3.5777195f, 0.3144679f},
                                           {-27.6687331f, 14.2647308f, -13.6492132f},
                                           {52.1761398f, -27.9436061f, 12.9441694f},
                                           {-50.7685254f, 29.0465828f, 4.2341530f},
                                           {18.6557051f, -11.4897735f, -5.6019615f}}};
// Polynomials of degree 5 for Turbo, by its author A. Mikhailov (Google, 2019).
constexpr std::array<glm::vec3, 6> kTurbo{{{0.13572138f, 0.09140261f, 0.10667330f},
                                           {4.61539260f, 2.19418839f, 12.64194608f},
                                           {-42.66032258f, 4.84296658f, -60.58204836f},
                                           {132.13108234f, -14.18503333f, 110.36276771f},
                                           {-152.94239396f, 4.27729857f, -89.90310912f},
                                           {59.28637943f, 2.82956604f, 27.34824973f}}};
// Cividis: J. Nunez, C. Anderton, R. Renslow, PLoS ONE 13 (2018). The polynomials of degree 5 are from M. Bostock's
// d3-scale-chromatic; their values are 0..255.
constexpr std::array<glm::vec3, 6> kCividis{{{-4.54f, 32.49f, 81.24f},
                                             {-35.34f, 170.73f, 442.36f},
                                             {2381.73f, 52.82f, -2482.43f},
                                             {-6402.7f, -131.46f, 6167.24f},
                                             {7024.72f, 176.58f, -6614.94f},
                                             {-2710.57f, -67.37f, 2475.67f}}};

glm::vec3 viridis(float place) { return polynomial(kViridis, place); }
glm::vec3 inferno(float place) { return polynomial(kInferno, place); }
glm::vec3 magma(float place) { return polynomial(kMagma, place); }
glm::vec3 turbo(float place) { return polynomial(kTurbo, place); }
glm::vec3 cividis(float place) {
  auto scaled = kCividis;
  for (glm::vec3& c : scaled) c /= 255.0f;
  return polynomial(scaled, place);
}

/// Polar form of CIE L*a*b* (K. Moreland, Diverging color maps for scientific visualization, 2009).
struct Msh {
  double m, s, h;
};

double srgb_of(double linear) {
  return linear > 0.0031308 ? 1.055 * std::pow(linear, 1 / 2.4) - 0.055 : 12.92 * linear;
}

glm::vec3 msh_color(const Msh& color) {
  const double lightness = color.m * std::cos(color.s), a = color.m * std::sin(color.s) * std::cos(color.h),
               b = color.m * std::sin(color.s) * std::sin(color.h);
  const auto part = [](double t) { return t > 6.0 / 29 ? t * t * t : 3 * (6.0 / 29) * (6.0 / 29) * (t - 4.0 / 29); };
  const double fy = (lightness + 16) / 116;
  const double x = 0.9505 * part(fy + a / 500), y = part(fy), z = 1.089 * part(fy - b / 200);  // white point D65
  return glm::clamp(
      glm::vec3(srgb_of(3.2406 * x - 1.5372 * y - 0.4986 * z), srgb_of(-0.9689 * x + 1.8758 * y + 0.0415 * z),
                srgb_of(0.0557 * x - 0.2040 * y + 1.0570 * z)),
      0.0f, 1.0f);
}

/// Returns the hue of an unsaturated colour of magnitude `m`, so that the transition to the saturated colour is smooth.
double adjusted_hue(const Msh& saturated, double m) {
  if (saturated.m >= m) return saturated.h;
  const double spin =
      saturated.s * std::sqrt(m * m - saturated.m * saturated.m) / (saturated.m * std::sin(saturated.s));
  return saturated.h > -std::numbers::pi / 3 ? saturated.h + spin : saturated.h - spin;
}

glm::vec3 cool_warm(float place) {
  constexpr Msh kCool{80, 1.08, -1.1}, kWarm{80, 1.08, 0.5};
  constexpr double kMiddle = 88;
  const bool cool = place < 0.5f;
  const Msh& end = cool ? kCool : kWarm;
  const double part = std::abs(1 - 2 * static_cast<double>(place));  // weight of the saturated end colour
  const double hue = adjusted_hue(end, kMiddle);
  return msh_color({kMiddle + part * (end.m - kMiddle), part * end.s, hue + part * (end.h - hue)});
}

constexpr std::array<ColorMap, 7> kMaps{{
    {"grey", "Grey", "Black to white", "", false, &grey_color},
    {"viridis", "Viridis", "Even steps, also in print and for colour-blind readers", "van der Walt and Smith 2015",
     false, &viridis},
    {"cividis", "Cividis", "Even steps that look alike to colour-blind readers", "Nunez et al. 2018", false, &cividis},
    {"inferno", "Inferno", "Black through red to yellow, even steps", "van der Walt and Smith 2015", false, &inferno},
    {"magma", "Magma", "Black through purple to cream, even steps", "van der Walt and Smith 2015", false, &magma},
    {"turbo", "Turbo", "Rainbow without bands; good for details, poor for magnitudes", "Mikhailov 2019", false, &turbo},
    {"coolwarm", "Cool to warm", "Blue below the middle, red above it", "Moreland 2009", true, &cool_warm},
}};

qnv::Rgb8 map_bytes(const glm::vec3& color) {
  const auto byte = [](float c) { return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255)); };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

}  // namespace

std::span<const ColorMap> color_maps() { return kMaps; }

const ColorMap* find_color_map(std::string_view name) {
  const auto found = std::find_if(kMaps.begin(), kMaps.end(), [&](const ColorMap& map) { return map.name == name; });
  return found == kMaps.end() ? nullptr : &*found;
}

std::string color_map_names() {
  std::string names;
  for (const ColorMap& map : kMaps) names += (names.empty() ? "" : ", ") + std::string(map.name);
  return names;
}

glm::vec3 color_at(const ColorMap& map, float place) { return map.color(place > 0 ? std::min(place, 1.0f) : 0.0f); }

std::vector<glm::vec3> palette_of(const ColorMap& map) {
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < kMapPoints; ++i)
    colors.push_back(color_at(map, static_cast<float>(i) / static_cast<float>(kMapPoints - 1)));
  return colors;
}

Transfer mapped_transfer(const ColorMap& map, OpacityRamp ramp) {
  Transfer transfer;
  for (std::size_t i = 0; i < kMapPoints; ++i) {
    const float place = static_cast<float>(i) / static_cast<float>(kMapPoints - 1);
    const float opacity = ramp == OpacityRamp::linear ? place
                          : ramp == OpacityRamp::ends ? std::abs(2 * place - 1)
                                                      : 0.5f;
    transfer.push_back({place, map_bytes(color_at(map, place)), opacity * kMaxMapOpacity});
  }
  return transfer;
}

Transfer recolored(const Transfer& transfer, const ColorMap& map) {
  Transfer result;
  // Keep the points of the transfer function for their opacities. Add points between them for the colours of the map.
  for (const qnv::TransferPoint& point : transfer) result.push_back({point.value, {}, point.opacity});
  for (std::size_t i = 0; i < kMapPoints; ++i) {
    const float place = static_cast<float>(i) / static_cast<float>(kMapPoints - 1);
    const bool near = std::any_of(transfer.begin(), transfer.end(), [&](const qnv::TransferPoint& point) {
      return std::abs(point.value - place) < 0.5f / static_cast<float>(kMapPoints - 1);
    });
    if (!near) result.push_back({place, {}, transfer_at(transfer, place).opacity});
  }
  result = sound_transfer(std::move(result));
  for (qnv::TransferPoint& point : result) point.color = map_bytes(color_at(map, point.value));
  return result;
}

}  // namespace gs::app
