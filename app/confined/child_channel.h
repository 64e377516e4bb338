#pragma once

#include "app/base/read_file.h"
#include "app/confined/decoder_channel.h"

#include <cstddef>
#include <span>
#include <string>

// The child's end of the channel to its parent (decoder_channel.h).
namespace gs::app {

/// Receives a request. Returns false if the parent ended.
[[nodiscard]] bool receive_request(DecodeRequest& request);
/// Sends an answer. Returns false if the parent ended.
[[nodiscard]] bool send_answer(const DecodeAnswer& answer);
/// Puts an error into an answer, shortened if it is too long.
void set_error(DecodeAnswer& answer, const std::string& message);
/// Waits until the parent has made room for results, copies them there and says so. Returns false if it ended.
[[nodiscard]] bool send_results(SharedMemory& result, std::span<const std::byte> bytes);
/// Asks the parent for a file to which the file in work refers. The parent sends its bytes, or a large file as a
/// descriptor, which is mapped. Ends this process if the parent ended.
[[nodiscard]] BytesResult ask_parent_for_file(SharedMemory& result, const std::string& reference);

}  // namespace gs::app
