#include "io/febio/known_words.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/base/names.h"

namespace dea::febio {
namespace {

/// Lists with commas: types, or <tags> of what has no type. A parameter that may stand several times has a star.
struct Row {
  Place place;
  const char* types;
  const char* taken;  ///< DEA takes them
  const char* others = "";
};

constexpr const char* kUncoupledOthers = "pressure_model,laugon,atol,mat_axis,fiber";
constexpr const char* kFibres = "c3,c4,c5,lam_max,active_contraction,pressure_model,laugon,atol,mat_axis,fiber";
constexpr const char* kRelaxation = "t1,t2,t3,t4,t5,t6,g1,g2,g3,g4,g5,g6,pressure_model,laugon,atol,mat_axis,fiber";
constexpr const char* kFluid =
    "permeability,phi0,fluid_density,tau,solvent_supply,active_supply,osmotic_coefficient,solute,fixed_charge_density,"
    "penalty,solid_bound,reaction,membrane_reaction,mat_axis,fiber";
constexpr const char* kJoint =
    "laugon,tolerance,gaptol,angtol,force_penalty,moment_penalty,penalty,auto_penalty,minaug,maxaug,force_damping,"
    "moment_damping,symmetric_stiffness";
constexpr const char* kContact =
    "ambient_concentration,ambient_pressure,auto_penalty,concentration_penalty,contact_frac,ctol,dual_proj,dxtol,"
    "flip_primary,flip_secondary,fric_coeff,fric_penalty,gap_offset,gaptol,knmult,ktmult,laugon,max_penalty_sf,"
    "max_traction,maxaug,minaug,mu,node_reloc,offset,offset_shells,penalty,penalty_sf,pressure_penalty,ptol,"
    "search_radius,search_tol,search_tolerance,seg_up,shell_bottom_primary,shell_bottom_secondary,smooth_aug,"
    "smooth_fls,snap_tol,special,symmetric_stiffness,tension,tolerance,two_pass,update_penalty";

/// They steer FEBio's solvers and its output, in 4.0 within <solver>.
constexpr const char* kControlOthers =
    "adaptor_re_solve,alpha,arc_length,arc_length_scale,beta,check_zero_diagonal,cmax,ctol,cycle_buffer,"
    "diverge_reform,do_reforms,dtol,dyn_damping,equation_order,equation_scheme,etol,force_partition,"
    "force_positive_concentrations,ftol,gamma,integration,line_search,linear_solver,logSolve,ls_check_jacobians,"
    "lsiter,lsmin,lstol,mass_lumping,max_refs,max_residual,max_ups,min_residual,mixed_formulation,optimize_bw,order,"
    "output_level,output_stride,plot_level,plot_range,plot_stride,plot_zero_state,predictor,pressure_stiffness,"
    "print_level,ptol,qn_method,qnmethod,reform_augment,reform_each_time_step,restart,rhoi,rtol,shell_formulation,"
    "shell_normal_nodal,solver,symmetric_biphasic,symmetric_stiffness,title,use_three_field_hex,use_three_field_quad,"
    "use_three_field_shell,use_three_field_tet,use_three_field_tri,vtol,zero_diagonal_tol";

/// FEBio 4's parameters, and those of older files that it passes over.
constexpr Row kRows[] = {
    {Place::Material,
     "neo-Hookean,isotropic elastic,St.Venant-Kirchhoff,natural neo-Hookean,isotropic Hencky,Holmes-Mow,EFD "
     "neo-Hookean",
     "E,v,density", "beta,ksi,mat_axis,fiber"},
    {Place::Material, "Mooney-Rivlin,Veronda-Westmann,coupled Mooney-Rivlin,coupled Veronda-Westmann",
     "c1,c2,k,density", kUncoupledOthers},
    {Place::Material, "trans iso Mooney-Rivlin,trans iso Veronda-Westmann", "c1,c2,k,density", kFibres},
    {Place::Material, "coupled trans-iso Mooney-Rivlin,coupled trans-iso Veronda-Westmann", "c1,c2,c3,c4,c5,k,density",
     "lam_max,lambda,mat_axis,fiber"},
    {Place::Material, "orthotropic elastic,Fung-ortho-compressible,Fung orthotropic",
     "E1,E2,E3,G12,G23,G31,v12,v23,v31,k,density", "c,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "Holzapfel-Gasser-Ogden,HGO unconstrained", "c,k1,k2,kappa,gamma,k,density",
     "pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "Ogden", "c1,c2,c3,c4,c5,c6,k,density",
     "m1,m2,m3,m4,m5,m6,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "Ogden unconstrained", "c1,c2,c3,c4,c5,c6,cp,density", "m1,m2,m3,m4,m5,m6,mat_axis,fiber"},
    {Place::Material, "incomp neo-Hookean,Gent", "G,k,density", "Jm,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "Yeoh", "c1,k,density", "c2,c3,c4,c5,c6,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "Arruda-Boyce", "mu,N,k,density", kUncoupledOthers},
    {Place::Material, "uncoupled Holmes-Mow", "mu,k,density", "beta,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "solid mixture", "*solid,*elastic,*mat,density", "mat_axis,fiber"},
    {Place::Material, "uncoupled solid mixture", "*solid,*elastic,*mat,k,density", kUncoupledOthers},
    {Place::Material, "viscoelastic", "elastic,solid,g0,density", kRelaxation},
    {Place::Material, "uncoupled viscoelastic", "elastic,solid,g0,k,density", kRelaxation},
    {Place::Material, "prestrain elastic", "elastic,solid,density", "prestrain,mat_axis,fiber"},
    {Place::Material, "uncoupled prestrain elastic", "elastic,solid,k,density",
     "prestrain,pressure_model,laugon,atol,mat_axis,fiber"},
    {Place::Material, "biphasic,biphasic-solute,triphasic,multiphasic", "solid,elastic,density", kFluid},
    {Place::Material, "rigid body", "center_of_mass,density", "E,v,override_com,parent_id,mat_axis,fiber"},

    {Place::Rigid, "rigid_fixed", "rb,Rx_dof,Ry_dof,Rz_dof,Ru_dof,Rv_dof,Rw_dof"},
    {Place::Rigid, "fix", "rb,dofs"},
    {Place::Rigid, "rigid_displacement,rigid_rotation,prescribe", "rb,dof,value,relative"},
    {Place::Rigid, "rigid_rotation_vector", "rb,vx,vy,vz,relative"},
    {Place::Rigid, "rigid_euler_angles", "rb,Ex,Ey,Ez", "convention,relative"},
    {Place::Rigid, "rigid_force,rigid_moment,force", "rb,dof,value,load_type,relative"},
    {Place::Rigid, "rigid_follower_force,follower force", "rb,force,insertion,relative"},
    {Place::Rigid, "rigid_follower_moment,follower moment", "rb,moment", "relative"},
    {Place::Rigid, "rigid_axial_force,<rigid_axial_force>", "rbA,rbB,ra,rb,force,relative"},
    {Place::Rigid, "rigid_cable,<rigid_cable>", "force,force_direction,relative,*rigid_cable_point"},
    {Place::Rigid, "<rigid_cable_point>", "rigid_body_id,position"},
    {Place::Rigid, "rigid spring", "body_a,body_b,insertion_a,insertion_b,k,free_length"},
    {Place::Rigid, "rigid contractile force", "body_a,body_b,insertion_a,insertion_b,f0"},
    {Place::Rigid, "rigid spherical joint",
     "body_a,body_b,joint_origin,laugon,prescribed_rotation,rotation_x,rotation_y,rotation_z,moment_x,moment_y,"
     "moment_z",
     kJoint},
    {Place::Rigid, "rigid revolute joint",
     "body_a,body_b,joint_origin,laugon,rotation_axis,transverse_axis,prescribed_rotation,rotation,moment,"
     "torsion_stiffness",
     kJoint},
    {Place::Rigid, "rigid prismatic joint",
     "body_a,body_b,joint_origin,laugon,translation_axis,transverse_axis,prescribed_translation,translation,force",
     kJoint},
    {Place::Rigid, "rigid cylindrical joint",
     "body_a,body_b,joint_origin,laugon,joint_axis,transverse_axis,prescribed_translation,translation,force,"
     "prescribed_rotation,rotation,moment",
     kJoint},
    {Place::Rigid, "rigid planar joint",
     "body_a,body_b,joint_origin,laugon,rotation_axis,translation_axis_1,prescribed_rotation,rotation,"
     "prescribed_translation_1,translation_1,prescribed_translation_2,translation_2",
     kJoint},
    {Place::Rigid, "rigid lock", "body_a,body_b,joint_origin,first_axis,second_axis", kJoint},
    {Place::Rigid, "generic rigid joint",
     "body_a,body_b,joint,prescribe_x,prescribe_y,prescribe_z,prescribe_Rx,prescribe_Ry,prescribe_Rz", kJoint},
    {Place::Rigid, "rigid joint", "body_a,body_b,joint", kJoint},

    {Place::Boundary, "zero displacement", "x_dof,y_dof,z_dof"},
    {Place::Boundary, "prescribed displacement", "dof,value,relative"},
    {Place::Boundary, "fix", "dofs"},
    {Place::Boundary, "prescribe", "dof,scale,relative"},
    {Place::Boundary, "<prescribe>", "scale,value,relative"},
    {Place::Boundary, "rigid", "rb", "clamp_shells"},
    {Place::Load, "nodal_load,nodal_force,<nodal_load>", "dof,scale,value,relative,shell_bottom"},

    {Place::Contact,
     "sliding-elastic,sliding-facet-on-facet,sliding-node-on-facet,sliding-biphasic,tied-node-on-facet,"
     "tied-facet-on-facet,sticky,sliding-biphasic-mixed,sliding-biphasic-solute,sliding-multiphasic,sliding2,sliding3,"
     "mortar-sliding,sliding-tension-compression,facet-to-facet sliding,sliding_with_gaps,sliding,tied,"
     "facet-to-facet tied,mortar-tied",
     "max_distance,offset", kContact},
    {Place::Contact, "tied-elastic,tied-biphasic,tied-multiphasic", "search_radius", kContact},

    {Place::Spring, "linear spring,tension-only linear spring", "E", "mat_axis"},
    {Place::Spring, "nonlinear spring", "force,measure,scale", "mat_axis"},
    {Place::Spring, "experimental spring", "E,sM,sm", "mat_axis"},
    {Place::Function, "point", "points,interpolate,extend,log"},
    {Place::Function, "math", "math"},
    {Place::Function, "const", "value"},
    {Place::Function, "linear ramp", "slope,intercept"},
    {Place::Controller, "loadcurve,<load_controller>", "points,interpolate,extend"},
    {Place::Controller, "math", "math,*var"},
    {Place::Control, "Control", "time_steps,step_size,final_time,analysis,time_stepper", kControlOthers},
};

/// Usual names elsewhere, no slips of the keyboard.
constexpr Alias kOtherNames[] = {{"nu", "v"},
                                 {"poisson", "v"},
                                 {"poissons_ratio", "v"},
                                 {"poisson_ratio", "v"},
                                 {"young", "E"},
                                 {"youngs", "E"},
                                 {"youngs_modulus", "E"},
                                 {"young_modulus", "E"},
                                 {"elastic_modulus", "E"},
                                 {"modulus", "E"},
                                 {"com", "center_of_mass"},
                                 {"bulk_modulus", "k"},
                                 {"shear_modulus", "G"},
                                 {"value", "scale"},
                                 {"scale", "value"},
                                 {"joint", "joint_origin"},
                                 {"joint_origin", "joint"},
                                 {"origin", "joint_origin"},
                                 {"joint_axis", "rotation_axis"},
                                 {"joint_axis", "translation_axis"},
                                 {"rotation_axis", "joint_axis"},
                                 {"translation_axis", "joint_axis"},
                                 {"axis", "rotation_axis"},
                                 {"axis", "translation_axis"},
                                 {"axis", "joint_axis"},
                                 {"stiffness", "k"},
                                 {"stiffness", "E"},
                                 {"k", "E"},
                                 {"rest_length", "free_length"},
                                 {"slack_length", "free_length"}};

struct Known {
  std::vector<std::string> taken, repeated, others;
};

std::vector<std::string> words_of(const char* list) {
  return *list == '\0' ? std::vector<std::string>() : split_words(list);
}

/// False: no such type is looked into.
bool known_in(Place place, const std::string& type, Known& known) {
  for (const Row& row : kRows) {
    if (row.place != place || !one_of(type, words_of(row.types))) continue;
    known = {words_of(row.taken), {}, words_of(row.others)};
    for (std::string& word : known.taken)
      if (word[0] == '*') known.repeated.push_back(word.erase(0, 1));
    return true;
  }
  return false;
}

/// As numbers, if they are some.
bool same_text(std::string_view a, std::string_view b) {
  const std::vector<std::string> one = split_words(a), two = split_words(b);
  return std::equal(one.begin(), one.end(), two.begin(), two.end(), [](const std::string& x, const std::string& y) {
    const auto first = whole_double(x), second = whole_double(y);
    return first && second ? *first == *second : trim(x) == trim(y);
  });
}

bool same(const Component& a, const Component& b) {
  return a.tag == b.tag && a.type == b.type && a.lc == b.lc && same_text(a.text, b.text) &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same);
}

[[noreturn]] void fail_twice(const Draft& draft, const Component& first, const Component& again,
                             const std::string& in) {
  const auto said = [](const Component& part) {
    return part.parts.empty()
               ? fmt::format(" = {}{}", quote(trim(part.text)), part.lc ? " with lc = " + quote(*part.lc) : "")
               : std::string();
  };
  fail(draft, again.origin,
       fmt::format("<{}>{} in {}, which has <{}>{} in line {} already: keep one (FEBio takes the last)", again.tag,
                   said(again), in, first.tag, said(first), first.origin.line));
}

/// Parameters of a contact that DEA does without and tells, or that a tie has.
bool is_looked_at(const Component& contact, const std::string& word) {
  if (word == "gap_offset" || word == "search_radius" || word == "max_distance") return true;
  const std::vector<ContactParameter> told = unused_contact_parameters(contact.type);
  return std::any_of(told.begin(), told.end(), [&](const ContactParameter& p) { return word == p.name; });
}

/// A word that is none of FEBio's in `in`: refused where one of `taken` may be meant, whose default would stand in for
/// it unseen; else told, once for all of a `kind`, with the one of `others` that may be meant.
void unknown_word(Draft& draft, Origin origin, std::string_view word, const std::string& in, const std::string& kind,
                  const std::vector<std::string>& taken, const std::vector<std::string>& others) {
  const std::string meant = nearest_name(word, taken, kOtherNames);
  if (!meant.empty())
    fail(draft, origin, fmt::format("<{}> in {} is none of FEBio's words: did you mean <{}>?", word, in, meant));
  ignore(draft, origin, fmt::format("<{}> in {}, none of FEBio's words{}", word, kind, did_you_mean(word, others)));
}

/// `in`: the component in a refusal; `kind`: the same for all of its type.
void check_parts(Draft& draft, const Component& component, const Known& known, const std::string& in,
                 const std::string& kind) {
  std::vector<std::string> missing;  // what DEA takes and does not find
  for (const std::string& word : known.taken)
    if (find(component, word) == nullptr || one_of(word, known.repeated)) missing.push_back(word);
  std::vector<std::string> all = known.taken;
  all.insert(all.end(), known.others.begin(), known.others.end());
  for (const Component& part : component.parts) {
    if (one_of(part.tag, known.taken) || (component.tag == "contact" && is_looked_at(component, part.tag))) {
      const Component* first = find(component, part.tag);
      if (first != &part && !one_of(part.tag, known.repeated) && !same(*first, part))
        fail_twice(draft, *first, part, in);
    } else if (!one_of(part.tag, known.others)) {
      unknown_word(draft, part.origin, part.tag, in, kind, missing, all);
    }
  }
}

std::string kind_of(const Component& component) {
  return component.type.empty() ? component.tag : fmt::format("{} {}", component.tag, quote(component.type));
}

std::string name_of(const Component& component) {
  return component.name.empty() ? kind_of(component) : fmt::format("{} {}", component.tag, quote(component.name));
}

/// `outer`: " of material "cartilage"", empty for the material itself.
void check_material(Draft& draft, const Component& material, const std::string& outer) {
  Known known;
  if (!known_in(Place::Material, material.type_or_tag(), known)) return;
  check_parts(draft, material, known, name_of(material) + outer, kind_of(material));
  const std::string within = outer.empty() ? " of " + name_of(material) : outer;
  for (const Component& part : material.parts)
    if (one_of(part.tag, {"solid", "elastic", "mat"})) check_material(draft, part, within);
}

}  // namespace

void check_words(Draft& draft, Place place, const Component& component) {
  Known known;
  if (!known_in(place, component.type.empty() ? "<" + component.tag + ">" : component.type, known)) return;
  check_parts(draft, component, known, name_of(component), kind_of(component));
  for (const Component& part : component.parts) {
    if (place == Place::Rigid && part.tag == "rigid_cable_point") check_words(draft, place, part);
    if (place == Place::Spring && part.tag == "force") check_words(draft, Place::Function, part);
  }
}

void check_control_word(Draft& draft, Origin origin, std::string_view word) {
  Known known;
  known_in(Place::Control, "Control", known);
  if (!one_of(word, known.others)) unknown_word(draft, origin, word, "Control", "Control", known.taken, known.others);
}

std::vector<std::string> material_types() {
  std::vector<std::string> types;
  for (const Row& row : kRows)
    for (const std::string& type : words_of(row.types))
      if (row.place == Place::Material) types.push_back(type);
  return types;
}

void check_material_words(Draft& draft, const Component& material) { check_material(draft, material, ""); }

}  // namespace dea::febio
