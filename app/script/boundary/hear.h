#pragma once

#include "app/script/boundary/message.h"

#include <span>

namespace gs::app::script {

/// Outcome of a message of programs.
enum class Heard : std::uint8_t { notices, question, report, impossible };

/// Tells the notices of a message to the world. After a question, writes the world's answer to `answer`. After a
/// report, stores it. Stops at the first impossible item.
[[nodiscard]] Heard hear(WorldAccess& world, std::span<const std::byte> message, MessageWriter& answer, Report& report);

}  // namespace gs::app::script
