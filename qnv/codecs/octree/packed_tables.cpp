#include "qnv/codecs/octree/packed_tables.h"

#include <cmath>
#include <vector>

namespace gs::qnv {
namespace {

// Ratio of the probabilities of consecutive magnitudes, in 1/256. One entry per model.
constexpr std::array<std::uint32_t, kResidualModels> kDecay = {4,   10,  18,  28,  40,  54,  70,  88,
                                                               106, 126, 146, 166, 186, 204, 222, 240};

ResidualModel make_model(std::uint32_t decay) {
  std::array<std::uint64_t, kResidualSymbols> weight{};
  std::uint64_t w = 1u << 24, sum = 0;
  for (std::uint32_t symbol = 0; symbol < kEscape; ++symbol) {
    if (symbol % 2 == 1) w = w * decay / 256;
    weight[symbol] = w;
  }
  weight[kEscape] = 2 * w * decay / (256 - decay);
  for (const std::uint64_t v : weight) sum += v;
  ResidualModel model;
  std::uint32_t used = 0;
  for (std::uint32_t symbol = 0; symbol < kResidualSymbols; ++symbol) {
    model.interval[symbol].frequency =
        static_cast<std::uint16_t>(1 + weight[symbol] * (kRansTotal - kResidualSymbols) / sum);
    used += model.interval[symbol].frequency;
  }
  model.interval[0].frequency = static_cast<std::uint16_t>(model.interval[0].frequency + (kRansTotal - used));
  std::uint32_t start = 0;
  for (std::uint32_t symbol = 0; symbol < kResidualSymbols; ++symbol) {
    model.interval[symbol].start = static_cast<std::uint16_t>(start);
    start += model.interval[symbol].frequency;
    model.cost[symbol] =
        static_cast<std::uint16_t>(256 * std::log2(static_cast<double>(kRansTotal) / model.interval[symbol].frequency) +
                                   (symbol == kEscape ? 256 * kEscapeBits : 0));
  }
  return model;
}

}  // namespace

const std::array<ResidualModel, kResidualModels>& residual_models() {
  static const std::array<ResidualModel, kResidualModels> models = [] {
    std::array<ResidualModel, kResidualModels> made;
    for (std::size_t i = 0; i < kResidualModels; ++i) made[i] = make_model(kDecay[i]);
    return made;
  }();
  return models;
}

const std::uint32_t* residual_slots() {
  static const std::vector<std::uint32_t> slots = [] {
    std::vector<std::uint32_t> made;
    made.reserve(kResidualModels * kRansTotal);
    for (const ResidualModel& model : residual_models())
      for (std::uint32_t symbol = 0; symbol < kResidualSymbols; ++symbol)
        for (std::uint32_t i = 0; i < model.interval[symbol].frequency; ++i)
          made.push_back(i | static_cast<std::uint32_t>(model.interval[symbol].frequency) << 12 | symbol << 25);
    return made;
  }();
  return slots.data();
}

const std::array<std::array<std::uint16_t, kOccupancyBins>, kOccupancyModels>& occupancy_models() {
  // Logistic curves of decreasing steepness. The rounded values are part of the format.
  static constexpr std::array<std::array<std::uint16_t, kOccupancyBins>, kOccupancyModels> kModels = {{
      {4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 85, 3256, 4090, 4092, 4092, 4092, 4092, 4092, 4092},
      {6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 14, 293, 2609, 3996, 4090, 4090, 4090, 4090, 4090, 4090},
      {8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 11, 90, 628, 2428, 3773, 4053, 4088, 4088, 4088, 4088, 4088},
      {16, 16, 16,  16,  16,   16,   16,   16,   16,   16,   16,   16,
       16, 64, 246, 836, 2076, 3297, 3862, 4035, 4080, 4080, 4080, 4080},
      {40, 40,  40,  40,   40,   40,   40,   40,   40,   40,   40,   41,
       99, 234, 528, 1087, 1920, 2798, 3442, 3800, 3970, 4043, 4056, 4056},
      {100, 100, 100, 100,  100,  100,  100,  100,  100,  100,  111,  192,
       327, 545, 873, 1324, 1874, 2450, 2967, 3369, 3650, 3831, 3941, 3996},
      {300, 300, 300,  300,  300,  300,  300,  300,  300,  300,  393,  535,
       718, 947, 1223, 1540, 1885, 2239, 2583, 2897, 3169, 3394, 3574, 3713},
      {800,  800,  800,  800,  800,  800,  800,  858,  969,  1089, 1218, 1356,
       1502, 1653, 1809, 1968, 2128, 2287, 2443, 2594, 2740, 2878, 3007, 3127},
  }};
  return kModels;
}

}  // namespace gs::qnv
