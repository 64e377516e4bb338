#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Maximum number of steps of a time series, and of steps times components.
inline constexpr std::size_t kMaxSteps = 4096, kMaxStepComponents = 16384;
/// Number of steps of a chain. Steps with a number that is a multiple of it do not depend on earlier steps.
inline constexpr std::size_t kChainSteps = 8;

/// Steps of a time series of volumes. FORMAT.md, "Time series".
struct StepTable {
  std::vector<double> times;          // finite, ascending; empty for a single volume
  std::vector<std::uint32_t> chunks;  // by step, then by component: chunks without parity
  friend bool operator==(const StepTable&, const StepTable&) = default;
};

/// Encodes the header section.
[[nodiscard]] std::vector<std::byte> encode_step_table(const StepTable& steps);
/// Decodes the header section. Returns nullopt if it is truncated, or contains invalid numbers. Safe for untrusted
/// bytes.
[[nodiscard]] std::optional<StepTable> decode_step_table(std::span<const std::byte> section, std::size_t components);

}  // namespace gs::qnv
