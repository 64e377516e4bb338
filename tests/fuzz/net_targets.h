#pragma once

#include "tests/fuzz/fuzz_target.h"

namespace gs::fuzz {

[[nodiscard]] bool run_cell_datagrams(std::span<const std::byte> bytes);
[[nodiscard]] bool run_control_client(std::span<const std::byte> bytes);
[[nodiscard]] bool run_tunnel(std::span<const std::byte> bytes);
[[nodiscard]] bool run_sftp(std::span<const std::byte> bytes);
[[nodiscard]] bool run_http_request(std::span<const std::byte> bytes);

}  // namespace gs::fuzz
