// io/convert/write_feb.h – a converted joint as FEBio XML, version 4.0: a whole file, or the model's own text
// with pieces put in.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/convert/conversion_plan.h"
#include "io/convert/xml_places.h"

namespace dea {

/// All digits, as short as they can be.
std::string exact(double value);
std::string exact(const Vector3d& v);  ///< "x,y,z"

/// What is inside `<contact type="dea">`.
XmlLines dea_contact_lines(const ConversionPlan& plan, const Contact& contact);
/// The SurfaceData with the thickness of a surface; nothing: it has no map. Every facet has as many values as the
/// largest one has nodes, as FEBio wants it; those beyond its own nodes repeat its last.
XmlLines thickness_map_lines(const ConversionPlan& plan, std::size_t surface);
/// What is inside a rigid `<material>`, and all of it.
XmlLines rigid_material_lines(const Material& material);
XmlLines material_lines(const Material& material);
XmlLines rigid_fixed_lines(const JointModel& model, const RigidFixed& fixed);

/// Full Newton with a matrix that is not symmetric (the spring bed's is not, where the bodies turn; unless the linear
/// solver takes no such matrix), to tolerances that give the pose of `dea run` to 1e-5 mm.
struct SolverParameter {
  const char* name;
  const char* value;
  const char* number;  ///< of the word `value` in FEBio's own list, which may stand in its place
  bool largest;        ///< the value is a bound: a smaller one that is not 0 stays
  bool smallest;       ///< likewise: a larger one stays
};
std::vector<SolverParameter> solver_parameters(const std::string& linear_solver);
/// Its qn_method.
XmlLines full_newton_lines();
XmlLines solver_lines(const std::string& module, const LinearSolver& linear_solver);
/// Nothing where none is named.
XmlLines linear_solver_lines(const LinearSolver& linear_solver);

/// Variables the plot file must have; FEBio's own, then the plugin's.
const std::vector<const char*>& plot_variables();
XmlLines plotfile_lines();

/// The model's own text with a few elements changed. `text`: of the model, version 4.0. Nothing when an element to be
/// changed is not in it (it is in an included file, or the text is not as expected); `why` then says which. Adds its
/// own changes (solver, plot file) to `plan.changes`.
std::optional<std::string> edit_feb(const JointModel& model, ConversionPlan& plan, const std::string& text,
                                    std::string& why);

/// A whole file. `dropped`: what is not part of the joint and not in it, a line each.
std::string write_feb(const JointModel& model, const ConversionPlan& plan, const std::string& encoding,
                      std::vector<std::string>& dropped);

}  // namespace dea
