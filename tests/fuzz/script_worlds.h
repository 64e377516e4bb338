#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Worlds with hostile Scripts. A world is one text: each of its files follows a line "==== NAME".
//   world.wrl    the world, at memory://a/world.wrl; a part without a name of this list is a file beside it
//   b/NAME       a file of another host, memory://b/NAME
//   next.wrl     also a world that begins when the first one is gone
//   beside.wrl   also a world that begins while the first one lives, and outlives it
//   input        rows of `ghostspace trace --input`
//   console      lines that run as parts of the first Script, in a session that follows loadURL
namespace gs::fuzz {

struct WorldPart {
  std::string_view name, text;
};
/// Splits the text of a world. Empty if no part is called world.wrl.
[[nodiscard]] std::vector<WorldPart> world_parts(std::string_view text);

/// Generates a world. The text depends on the seed alone.
[[nodiscard]] std::string make_script_world(std::uint64_t seed);

/// Runs a world as `ghostspace trace` does, then its other worlds and its session. Ends the program if an invariant
/// fails. Prints the messages of the first world if `verbose`. Returns true if that has a scene.
bool play_script_world(std::string_view text, bool verbose);

}  // namespace gs::fuzz
