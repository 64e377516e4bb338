#pragma once

#include <jsapi.h>

#include <exception>

namespace gs::app::script {

/// Calls a function for the engine. Exceptions must not pass through the frames of the engine. Here they only mean that
/// memory is exhausted, so they become the engine's out-of-memory error.
template <class Function>
bool contain(JSContext* context, const Function& function) noexcept {
  try {
    return function();
  } catch (const std::exception&) {
    JS_ReportOutOfMemory(context);
    return false;
  }
}

/// Implementation of contained.
template <auto kFunction, class Type = decltype(kFunction)>
struct Contained;
template <auto kFunction, class... Parameters>
struct Contained<kFunction, bool (*)(JSContext*, Parameters...)> {
  static bool call(JSContext* context, Parameters... parameters) noexcept {
    return contain(context, [&] { return kFunction(context, parameters...); });
  }
};

/// A function that the engine calls, with the same parameters. Exceptions become errors of the engine.
template <auto kFunction>
inline constexpr auto contained = &Contained<kFunction>::call;

}  // namespace gs::app::script
