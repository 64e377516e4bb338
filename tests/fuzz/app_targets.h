#pragma once

#include "tests/fuzz/fuzz_target.h"

namespace gs::fuzz {

[[nodiscard]] bool run_control_messages(std::span<const std::byte> bytes);
[[nodiscard]] bool run_program_messages(std::span<const std::byte> bytes);
[[nodiscard]] bool run_asset_transfer(std::span<const std::byte> bytes);
[[nodiscard]] bool run_volume_transfer(std::span<const std::byte> bytes);
[[nodiscard]] bool run_script_world(std::span<const std::byte> bytes);

}  // namespace gs::fuzz
