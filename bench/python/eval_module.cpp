// SPDX-License-Identifier: BSD-3-Clause
/// The extension module `stillpoint._eval`, and the exception of all modules of the package.
#include "bench/python/eval_bindings.h"
#include "core/base/error.h"

PYBIND11_MODULE(_eval, module) {
  module.doc() = "Trajectory evaluation; the public names are those of stillpoint.eval.";
  // A translator of one module serves all that share pybind11's internals.
  auto& error = pybind11::register_exception<stillpoint::InputError>(module, "InputError", PyExc_ValueError);
  error.attr("__module__") = "stillpoint";
  error.attr("__doc__") = "Invalid input: the message has place, problem and remedy, as that of the program.";
  stillpoint::python::bind_trajectories(module);
  stillpoint::python::bind_metrics(module);
  stillpoint::python::bind_consistency(module);
  stillpoint::python::bind_statistics(module);
}
