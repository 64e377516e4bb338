#pragma once

#include "app/script/bounds/contained.h"

#include <js/Object.h>
#include <js/PropertyAndElement.h>
#include <js/Proxy.h>
#include <jsfriendapi.h>

namespace gs::app::script {

/// Base of the proxies for values of a world. They have an ordinary prototype, accept new properties at any time, and
/// are finalized on the world's thread. A definition sets the value; a deletion does nothing.
class LiveProxyHandler : public js::BaseProxyHandler {
 public:
  explicit constexpr LiveProxyHandler(const void* family) : BaseProxyHandler(family) {}

  bool finalizeInBackground(const JS::Value&) const override { return false; }
  bool getPrototypeIfOrdinary(JSContext*, JS::HandleObject proxy, bool* is_ordinary,
                              JS::MutableHandleObject prototype) const override {
    *is_ordinary = true;
    prototype.set(js::GetStaticPrototype(proxy));
    return true;
  }
  bool preventExtensions(JSContext*, JS::HandleObject, JS::ObjectOpResult& result) const override {
    return result.failCantPreventExtensions();
  }
  bool defineProperty(JSContext* context, JS::HandleObject proxy, JS::HandleId id,
                      JS::Handle<JS::PropertyDescriptor> descriptor, JS::ObjectOpResult& result) const override {
    if (descriptor.isAccessorDescriptor()) return result.failInvalidDescriptor();
    JS::RootedValue value(context, descriptor.hasValue() ? descriptor.value().get() : JS::UndefinedValue());
    JS::RootedValue receiver(context, JS::ObjectValue(*proxy));
    return set(context, proxy, id, value, receiver, result);
  }
  bool delete_(JSContext*, JS::HandleObject, JS::HandleId, JS::ObjectOpResult& result) const override {
    return result.succeed();
  }
  bool isExtensible(JSContext*, JS::HandleObject, bool* extensible) const override {
    *extensible = true;
    return true;
  }

 protected:
  // Reports whether the prototype has a property. Programs may set any prototype, even null.
  static bool has_inherited(JSContext* context, JS::HandleObject proxy, JS::HandleId id, bool* found) {
    JS::RootedObject prototype(context, js::GetStaticPrototype(proxy));
    *found = false;
    return !prototype || JS_HasPropertyById(context, prototype, id, found);
  }
  static bool get_inherited(JSContext* context, JS::HandleObject proxy, JS::HandleId id, JS::HandleValue receiver,
                            JS::MutableHandleValue result) {
    JS::RootedObject prototype(context, js::GetStaticPrototype(proxy));
    result.setUndefined();
    return !prototype || JS_ForwardGetPropertyTo(context, prototype, id, receiver, result);
  }
};

/// A handler that turns exceptions into errors of the engine.
template <class Handler>
class ContainedHandler final : public Handler {
 public:
  bool ownPropertyKeys(JSContext* context, JS::HandleObject proxy, JS::MutableHandleIdVector keys) const override {
    return contain(context, [&] { return Handler::ownPropertyKeys(context, proxy, keys); });
  }
  bool getOwnPropertyDescriptor(JSContext* context, JS::HandleObject proxy, JS::HandleId id,
                                JS::MutableHandle<mozilla::Maybe<JS::PropertyDescriptor>> found) const override {
    return contain(context, [&] { return Handler::getOwnPropertyDescriptor(context, proxy, id, found); });
  }
  bool has(JSContext* context, JS::HandleObject proxy, JS::HandleId id, bool* found) const override {
    return contain(context, [&] { return Handler::has(context, proxy, id, found); });
  }
  bool get(JSContext* context, JS::HandleObject proxy, JS::HandleValue receiver, JS::HandleId id,
           JS::MutableHandleValue result) const override {
    return contain(context, [&] { return Handler::get(context, proxy, receiver, id, result); });
  }
  bool set(JSContext* context, JS::HandleObject proxy, JS::HandleId id, JS::HandleValue value, JS::HandleValue receiver,
           JS::ObjectOpResult& result) const override {
    return contain(context, [&] { return Handler::set(context, proxy, id, value, receiver, result); });
  }
};

}  // namespace gs::app::script
