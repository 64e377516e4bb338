#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Worlds with hostile Scripts. A world is one text with all its files. Each file follows a line "==== NAME":
//   world.wrl    the world, at memory://a/world.wrl; other names are files in the same folder
//   b/NAME       a file of another host, memory://b/NAME
//   next.wrl     also a world that starts after the first world has ended
//   beside.wrl   also a world that starts while the first world runs, and runs longer
//   input        rows of `ghostspace trace --input`
//   console      lines that the first Script evaluates, in a session that follows loadURL
namespace gs::fuzz {

struct WorldPart {
  std::string_view name, text;
};
/// Splits the text of a world into its files. Returns an empty list if no file is called world.wrl.
[[nodiscard]] std::vector<WorldPart> world_parts(std::string_view text);

/// Generates a world. The text depends only on the seed.
[[nodiscard]] std::string make_script_world(std::uint64_t seed);

/// Runs a world as `ghostspace trace` does, then its other worlds and its session. Ends the program if an invariant
/// fails. Prints the messages of the first world if `verbose`. Returns true if the first world has a scene.
bool play_script_world(std::string_view text, bool verbose);

}  // namespace gs::fuzz
