// include/febiodea/febiodea.h – the front door: what the library offers, from a model's file to results in one.
//
// * read_feb: file -> JointModel (io/feb/read_feb.h)
// * recognise: JointModel, Settings -> Recognition (run/recognise.h)
// * analyse: Recognition -> Analysis (run/analysis.h)
// * Analysis::findings: what is to be known of it; severity, worded: Finding -> warning or note, text (rules/rules.h)
// * make_plot_file: Recognition, Analysis -> XpltFile (io/results/plot_file.h)
// * write_xplt, read_xplt (io/xplt/xplt.h)
//
// and, for many load cases on one joint:
//
// * prepare: Recognition -> Prepared (run/prepared.h)
// * make_load_case: JointModel, Joint -> LoadCase (equilibrium/load_case.h)
// * solve: Prepared, LoadCase, Start -> Equilibrium
// * press: Prepared, poses -> pressures, force and moment on each body, their derivative
//
// Units are the model's own throughout; places are global, in the model's frame. Values own what they hold and may be
// used by several threads at a time. What takes long ends with Stopped when the flag it was given is set (base/stop.h).
// Faults of the user are thrown as InputError, UsageError and WriteError (base/error.h), each with one line that says
// what to do; recognise gives a model's faults as values instead.
#pragma once
#include "io/feb/read_feb.h"
#include "io/results/plot_file.h"
#include "io/xplt/xplt.h"
#include "src/base/error.h"
#include "src/base/stop.h"
#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/times.h"
#include "src/model/settings.h"
#include "src/results/fields.h"
#include "src/results/statistics.h"
#include "src/rules/rules.h"
#include "src/run/analysis.h"
#include "src/run/check.h"
#include "src/run/convergence.h"
#include "src/run/prepared.h"
#include "src/run/recognise.h"
#include "src/run/states.h"
#include "src/springs/place.h"
#include "src/springs/press.h"
#include "src/springs/wrench.h"
#include "src/version.h"
