// How long a step of the execution model takes: `events_bench FILE...` prints, for each world, the ROUTEs, the time to
// connect them, and the median and the longest of 600 steps of 1/60 s, in milliseconds of one core.
#include "vrml/events/execution.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

}  // namespace

int main(int count, char** arguments) {
  constexpr double kStart = 946684800;
  constexpr int kSteps = 600;
  std::printf("%-40s %10s %12s %12s %12s %12s\n", "world", "ROUTEs", "connect ms", "step ms", "longest ms", "changes");
  for (int i = 1; i < count; ++i) {
    std::ifstream file(arguments[i], std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    gs::vrml::SceneGraph scene(arguments[i]);
    gs::vrml::Diagnostics diagnostics;
    (void)gs::vrml::parse(text.str(), scene, diagnostics);
    const Clock::time_point connecting = Clock::now();
    gs::vrml::Execution execution(scene);
    execution.start(kStart);
    const double connected = milliseconds(connecting);
    std::vector<double> steps;
    std::size_t changes = 0;
    for (int step = 1; step <= kSteps; ++step) {
      const Clock::time_point begin = Clock::now();
      execution.step(kStart + step / 60.0);
      changes = execution.take_changes().size();
      steps.push_back(milliseconds(begin));
    }
    std::sort(steps.begin(), steps.end());
    std::printf("%-40s %10zu %12.2f %12.3f %12.3f %12zu\n", arguments[i], scene.routes().size(), connected,
                steps[steps.size() / 2], steps.back(), changes);
  }
  return 0;
}
