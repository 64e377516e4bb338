#include "app/interface/base/rate_choice.h"

#include "app/inspect/stream_list.h"

#include <imgui.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

namespace gs::app {
namespace {

constexpr std::uint64_t kRates[] = {0,         64'000,    128'000,    256'000,    512'000,    1'000'000,
                                    2'000'000, 5'000'000, 10'000'000, 20'000'000, 50'000'000, 100'000'000};

std::string rate_text(std::uint64_t rate) { return rate == 0 ? "no limit" : readable_rate(static_cast<double>(rate)); }

}  // namespace

std::optional<std::uint64_t> rate_choice(const char* id, std::uint64_t rate, float width) {
  std::optional<std::uint64_t> chosen;
  ImGui::SetNextItemWidth(width);
  if (!ImGui::BeginCombo(id, rate_text(rate).c_str(), ImGuiComboFlags_HeightLarge)) return chosen;
  // Add a rate from the command line to the list if it is not one of kRates.
  std::vector<std::uint64_t> rates(std::begin(kRates), std::end(kRates));
  if (std::find(rates.begin(), rates.end(), rate) == rates.end())
    rates.insert(std::upper_bound(rates.begin(), rates.end(), rate), rate);
  for (const std::uint64_t one : rates)
    if (ImGui::Selectable(rate_text(one).c_str(), one == rate) && one != rate) chosen = one;
  ImGui::EndCombo();
  return chosen;
}

}  // namespace gs::app
