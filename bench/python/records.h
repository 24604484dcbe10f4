// SPDX-License-Identifier: BSD-3-Clause
/// Structs of the libraries as Python classes: results with read-only fields, options with keyword arguments.
/// Both have `to_dict` and a text that names the fields. Choices are strings, spelled as on the command line.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "core/base/error.h"
#include "core/base/fields.h"

namespace stillpoint::python {

namespace py = pybind11;

template <class Enum>
std::string name_of(Enum value) {
  for (const auto& [known, name] : enum_names(Enum{}))
    if (known == value) return std::string(name);
  return {};
}

/// @throws InputError that lists the names of the choices
template <class Enum>
Enum value_of(const std::string& argument, const std::string& name) {
  std::string names;
  for (const auto& [value, known] : enum_names(Enum{})) {
    if (known == name) return value;
    names += (names.empty() ? "" : ", ") + std::string(known);
  }
  throw InputError(argument, "unknown value \"" + name + "\"; expected one of: " + names);
}

/// Defines the class of a result: each field is a read-only attribute.
template <class Struct>
class Record {
 public:
  Record(py::module_& module, const char* name, const char* doc) : type_(module, name, doc) {
    type_.attr("__fields__") = py::tuple();
    type_.def(
        "to_dict",
        [](const py::object& self) {
          py::dict values;
          for (const py::handle field : self.attr("__fields__")) values[field] = self.attr(py::str(field));
          return values;
        },
        "The fields as a dict.");
    type_.def("__repr__", [](const py::object& self) {
      std::string text;
      for (const py::handle field : self.attr("__fields__")) {
        text += (text.empty() ? "" : ", ") + py::str(field).cast<std::string>() + "=" +
                py::repr(self.attr(py::str(field))).cast<std::string>();
      }
      return py::str(py::type::of(self).attr("__name__")).cast<std::string>() + "(" + text + ")";
    });
  }

  template <class Getter>
  Record& field(const char* name, Getter getter, const char* doc) {
    if constexpr (std::is_member_object_pointer_v<Getter>) {
      type_.def_readonly(name, getter, doc);
    } else {
      type_.def_property_readonly(name, getter, doc);
    }
    return add(name);
  }

  template <class Enum>
  Record& choice(const char* name, Enum Struct::*member, const char* doc) {
    return field(
        name, [member](const Struct& value) { return name_of(value.*member); }, doc);
  }

  /// For methods, and properties that are no fields.
  [[nodiscard]] py::class_<Struct> type() const { return type_; }

 protected:
  Record& add(const char* name) {
    type_.attr("__fields__") = py::tuple(type_.attr("__fields__")) + py::make_tuple(name);
    return *this;
  }

  py::class_<Struct> type_;
};

/// @throws TypeError if an object has no field with the name
inline void require_field(const py::handle& object, const py::handle& name) {
  const py::object fields = object.attr("__fields__");
  if (fields.contains(name)) return;
  const std::string names = py::str(", ").attr("join")(fields).cast<std::string>();
  throw py::type_error("unknown option \"" + name.cast<std::string>() + "\"; expected one of: " + names);
}

/// Sets fields of options.
/// @throws TypeError if they have no field with the name
template <class Struct>
void assign(Struct& options, const py::kwargs& values) {
  const py::object self = py::cast(&options, py::return_value_policy::reference);
  for (const auto& [key, value] : values) {
    require_field(self, key);
    py::setattr(self, key, value);
  }
}

/// For options that are made in another way than by default.
struct WithoutDefaults {};

/// Defines the class of options: each field is an attribute and a keyword argument.
template <class Struct>
class Options : public Record<Struct> {
 public:
  Options(py::module_& module, const char* name, const char* doc)
      : Options(module, name, doc, WithoutDefaults{}) {
    this->type_.def(py::init([](const py::kwargs& values) {
      auto options = std::make_unique<Struct>();
      assign(*options, values);
      return options;
    }));
  }

  Options(py::module_& module, const char* name, const char* doc, WithoutDefaults)
      : Record<Struct>(module, name, doc) {}

  template <class Value>
  Options& field(const char* name, Value Struct::*member, const char* doc) {
    this->type_.def_readwrite(name, member, doc);
    this->add(name);
    return *this;
  }

  /// A number > 0, which may be infinite.
  Options& number(const char* name, double Struct::*member, const char* doc) {
    return property(name,
                    std::pair([member](const Struct& value) { return value.*member; },
                              [member, name](Struct& value, double number) {
                                if (!(number > 0.0)) throw InputError(name, "must be a number > 0");
                                value.*member = number;
                              }),
                    doc);
  }

  template <class Getter, class Setter>
  Options& property(const char* name, const std::pair<Getter, Setter>& access, const char* doc) {
    this->type_.def_property(name, access.first, access.second, doc);
    this->add(name);
    return *this;
  }

  template <class Enum>
  Options& choice(const char* name, Enum Struct::*member, const char* doc) {
    return property(name,
                    std::pair([member](const Struct& value) { return name_of(value.*member); },
                              [member, name](Struct& value, const std::string& text) {
                                value.*member = value_of<Enum>(name, text);
                              }),
                    doc);
  }
};

}  // namespace stillpoint::python
