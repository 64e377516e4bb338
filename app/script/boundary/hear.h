#pragma once

#include "app/script/boundary/message.h"

#include <functional>
#include <span>

namespace gs::app::script {

/// Outcome of a message of programs.
enum class Heard : std::uint8_t { all, question, impossible };

/// Tells the notices of a message to the world, and passes its reports to `reported`. A question must be the last item;
/// its answer is written to `answer`. Stops at the first impossible item, or if `reported` returns false.
[[nodiscard]] Heard hear(WorldAccess& world, std::span<const std::byte> message, MessageWriter& answer,
                         const std::function<bool(const Report&)>& reported);

}  // namespace gs::app::script
