#include "app/session/live/live_control.h"

#include "app/loading/updates/live_data.h"
#include "net/base/url.h"
#include "net/control/control_token.h"
#include "net/files/file.h"
#include "net/serve/served_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxLiveEntries = 64, kLongestLiveText = 100;

std::string live_text(const nlohmann::json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_string()) return {};
  return found->get<std::string>().substr(0, kLongestLiveText);
}

double live_number(const nlohmann::json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : NAN;
}

}  // namespace

std::optional<LiveState> read_live_state(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("version")) return std::nullopt;
  LiveState state;
  state.field = live_text(json, "field");
  if (const auto fields = json.find("fields"); fields != json.end() && fields->is_array())
    for (const auto& field : *fields)
      if (field.is_string() && state.fields.size() < kMaxLiveEntries)
        state.fields.push_back(field.get<std::string>().substr(0, kLongestLiveText));
  const auto parameters = json.find("parameters");
  if (parameters == json.end() || !parameters->is_array()) return state;
  for (const auto& one : *parameters) {
    if (!one.is_object() || state.parameters.size() >= kMaxLiveEntries) continue;
    LiveParameter made{live_text(one, "name"),
                       live_text(one, "label"),
                       live_text(one, "unit"),
                       live_number(one, "minimum"),
                       live_number(one, "maximum"),
                       live_number(one, "value"),
                       false};
    if (const auto integer = one.find("integer"); integer != one.end() && integer->is_boolean())
      made.integer = integer->get<bool>();
    constexpr double kLargest = 1e300;  // limit of sliders
    if (made.name.empty() || std::abs(made.minimum) > kLargest || std::abs(made.maximum) > kLargest ||
        !std::isfinite(made.minimum) || !std::isfinite(made.maximum) || !(made.minimum <= made.maximum) ||
        !std::isfinite(made.value))
      continue;
    if (made.label.empty()) made.label = made.name;
    state.parameters.push_back(std::move(made));
  }
  return state;
}

std::string parameter_query(std::string_view name, double value) {
  char number[32];
  const auto end = std::to_chars(number, number + sizeof number, value);
  // A '+', as in 1e+05, is a blank in queries.
  return net::encode_name(name) + "=" + net::encode_name({number, end.ptr});
}

std::string token_of_simulation(const std::string& url) {
  const net::Url parsed = net::parse_url(url);
  const auto place = net::host_and_port(parsed.authority);
  if (!place ||
      (place->host != "127.0.0.1" && place->host != "localhost" && place->host != "::1" && place->host != "[::1]"))
    return {};
  const std::string path = net::usual_token_file(static_cast<std::uint16_t>(place->port.value_or(80)));
  if (path.empty()) return {};
  auto file = net::map_file(path);
  const auto* mapped = std::get_if<net::MappedFile>(&file);
  constexpr std::size_t kDigits = 32;
  if (!mapped || mapped->bytes().size() < kDigits || mapped->bytes().size() > kDigits + 2) return {};
  std::string token(reinterpret_cast<const char*>(mapped->bytes().data()), kDigits);
  const bool hexadecimal = std::ranges::all_of(
      token, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); });
  return hexadecimal ? token : std::string();
}

std::string LiveControl::active_url() const {
  const Panes& panes = viewports_.panes();
  const View* const view = panes.at(panes.active()).view();
  if (!view || step_.simulated || load_.offline || view->document->world.live.empty()) return {};
  const net::Url base = net::parse_url(live_address(view->document->world.path));
  if (base.scheme != "http" && base.scheme != "https" && base.scheme != "ssh") return {};
  const net::Url target = net::resolve(base, net::parse_url(view->document->world.live));
  // Accepts only resources on the server of the world.
  return target.scheme == base.scheme && target.authority == base.authority ? target.text() : std::string();
}

void LiveControl::check() {
  const std::string url = active_url();
  if (url != url_) {
    url_ = url;
    state_.reset();
    changes_.clear();
    message_.clear();
    stale_ = coming_.valid();
    due_ = step_.now;
  }
  if (coming_.valid() && coming_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const SmallAnswer answer = coming_.get();
    const bool stale = std::exchange(stale_, false);
    due_ = stale || changing_ ? step_.now : step_.now + kWait;
    if (stale) {
      // The answer belongs to the simulation before.
    } else if (changing_) {
      message_ = answer.problem;
    } else if (answer.problem.empty()) {
      if (auto read = read_live_state(answer.body)) {
        state_ = std::move(read);
        state_->url = url_;
      }
    }
    if (state_) state_->message = message_;
    step_.frame.news = true;
  }
  if (url_.empty() || coming_.valid() || (changes_.empty() && step_.now < due_)) return;
  net::Request request;
  request.url = url_;
  changing_ = !changes_.empty();
  if (changing_) {
    const auto [query, token] = changes_.front();
    changes_.erase(changes_.begin());
    request.post = true;
    request.authorization = "Bearer " + (token.empty() ? token_of_simulation(url_) : token);
    request.url = net::resolve(net::parse_url(url_), net::parse_url("parameters?" + query)).text();
  }
  coming_ = std::async(std::launch::async, [this, request = std::move(request)] {
    SmallAnswer answer = small_request(request, false, load_, stop_);
    wake_();
    return answer;
  });
}

std::optional<double> LiveControl::next_due() const {
  if (url_.empty()) return std::nullopt;
  // The thread wakes the session shortly before its result is ready.
  constexpr double kSoon = 0.05;
  return coming_.valid() ? step_.now + kSoon : due_;
}

void LiveControl::change(const std::string& query, const std::string& token) {
  if (url_.empty()) return;
  constexpr std::size_t kMaxWaiting = 64;
  if (changes_.size() < kMaxWaiting) changes_.emplace_back(query, token);
  due_ = step_.now;
}

}  // namespace gs::app
