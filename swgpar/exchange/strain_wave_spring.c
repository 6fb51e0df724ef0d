/* A strain wave gear as a torsional spring with ripple and friction, after FMI 2.0: co-simulation
   and model exchange.

   docs/theory/spring_model.md has the equations. drive.h, written by swgpar, has the tables and
   start values of a drive. Units are N m, rad and s. There are no states: outputs follow from the
   inputs at the same time.

   SPDX-License-Identifier: BSD-3-Clause */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drive.h"

/* The types of the standard; a program may include its fmi2Functions.h before, which has the same
 * ones. */
#ifndef fmi2Functions_h
typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Char, fmi2Byte;
typedef const fmi2Char* fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
  fmi2DoStepStatus,
  fmi2PendingStatus,
  fmi2LastSuccessfulTime,
  fmi2Terminated
} fmi2StatusKind;
typedef struct fmi2CallbackFunctions fmi2CallbackFunctions;
typedef struct {
  fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
      valuesOfContinuousStatesChanged, nextEventTimeDefined;
  fmi2Real nextEventTime;
} fmi2EventInfo;
#define fmi2False 0
#endif

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

/* Value references, in the order of modelDescription.xml. */
enum {
  WAVE_GENERATOR_ANGLE,
  WAVE_GENERATOR_SPEED,
  OUTPUT_ANGLE,
  OUTPUT_SPEED,
  FRICTION_TORQUE,
  FRICTION_SPEED,
  LOSS_TORQUE,
  LOAD_LOSS,
  LOSS_SPEED,
  VISCOUS_LOSS,
  OUTPUT_DRAG,
  OUTPUT_VISCOUS_DRAG,
  DAMPING,
  WAVE_GENERATOR_START_ANGLE,
  OUTPUT_START_ANGLE,
  N_GIVEN,
  WAVE_GENERATOR_TORQUE = N_GIVEN,
  OUTPUT_TORQUE,
  WINDUP,
  KINEMATIC_ERROR,
  N_VARIABLES
};

typedef struct {
  double value[N_VARIABLES];
  int is_current; /* whether the outputs belong to the inputs */
} Spring;

/* Value at x of the cubic polynomials between n knots, and its derivative; straight beyond the
 * ends. */
static double interpolate(const double (*knot)[3], int n, double x, double* derivative) {
  int low = 0, high = n - 1;
  if (x <= knot[0][0] || x >= knot[high][0]) {
    const double* end = knot[x <= knot[0][0] ? 0 : high];
    *derivative = end[2];
    return end[1] + end[2] * (x - end[0]);
  }
  while (high - low > 1) {
    int middle = (low + high) / 2;
    *(x < knot[middle][0] ? &high : &low) = middle;
  }
  const double *a = knot[low], *b = knot[high], h = b[0] - a[0], s = (x - a[0]) / h,
               chord = (b[1] - a[1]) / h;
  const double c = 3.0 * chord - 2.0 * a[2] - b[2], d = a[2] + b[2] - 2.0 * chord;
  *derivative = a[2] + s * (2.0 * c + 3.0 * s * d);
  return a[1] + h * s * (a[2] + s * (c + s * d));
}

static void evaluate(Spring* spring) {
  double *v = spring->value, error_slope, stiffness;
  const double angle = v[WAVE_GENERATOR_ANGLE] - v[WAVE_GENERATOR_START_ANGLE];
  const double pitches = floor((angle - RIPPLE[0][0]) / PERIOD);
  const double error = interpolate(RIPPLE, N_RIPPLE, angle - PERIOD * pitches, &error_slope);
  const double transmission =
      1.0 / RATIO + error_slope; /* d(output angle) / d(wave generator's angle), rigid */
  const double windup = v[OUTPUT_ANGLE] - v[OUTPUT_START_ANGLE] - angle / RATIO - error;
  const double windup_speed = v[OUTPUT_SPEED] - transmission * v[WAVE_GENERATOR_SPEED];
  const double torque = interpolate(SPRING, N_SPRING, windup, &stiffness) +
                        v[DAMPING] * windup_speed +
                        v[FRICTION_TORQUE] * tanh(windup_speed / v[FRICTION_SPEED]);
  v[WINDUP] = windup;
  v[KINEMATIC_ERROR] = error;
  const double loss = v[LOSS_TORQUE] + v[LOAD_LOSS] * fabs(torque);
  v[OUTPUT_TORQUE] = -torque - v[OUTPUT_VISCOUS_DRAG] * v[OUTPUT_SPEED] -
                     v[OUTPUT_DRAG] * tanh(v[OUTPUT_SPEED] * fabs(RATIO) / v[LOSS_SPEED]);
  v[WAVE_GENERATOR_TORQUE] = transmission * torque - v[VISCOUS_LOSS] * v[WAVE_GENERATOR_SPEED] -
                             loss * tanh(v[WAVE_GENERATOR_SPEED] / v[LOSS_SPEED]);
  spring->is_current = 1;
}

/* A function that only answers */
#define ANSWER(Name, answer, ...) \
  EXPORTED fmi2Status fmi2##Name(__VA_ARGS__) { return answer; }

/* Life of an instance */

EXPORTED const char* fmi2GetTypesPlatform(void) { return "default"; }
EXPORTED const char* fmi2GetVersion(void) { return "2.0"; }

EXPORTED fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                       fmi2String resources, const fmi2CallbackFunctions* functions,
                                       fmi2Boolean visible, fmi2Boolean log) {
  Spring* spring;
  if (!guid || strcmp(guid, GUID) != 0 || !(spring = calloc(1, sizeof(Spring)))) return NULL;
  memcpy(spring->value, START, sizeof(START));
  return spring;
}

EXPORTED void fmi2FreeInstance(fmi2Component c) { free(c); }

ANSWER(SetupExperiment, fmi2OK, fmi2Component c, fmi2Boolean tolerance_given, fmi2Real tolerance,
       fmi2Real start, fmi2Boolean stop_given, fmi2Real stop)

EXPORTED fmi2Status fmi2Reset(fmi2Component c) {
  Spring* spring = c;
  memcpy(spring->value, START, sizeof(START));
  spring->is_current = 0;
  return fmi2OK;
}

ANSWER(EnterInitializationMode, fmi2OK, fmi2Component c)
ANSWER(ExitInitializationMode, fmi2OK, fmi2Component c)
ANSWER(Terminate, fmi2OK, fmi2Component c)

ANSWER(SetDebugLogging, fmi2OK, fmi2Component c, fmi2Boolean on, size_t n,
       const fmi2String categories[])

/* Variables: all are real numbers */

EXPORTED fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference reference[], size_t n,
                                fmi2Real value[]) {
  Spring* spring = c;
  if (!spring->is_current) evaluate(spring);
  for (size_t k = 0; k < n; k++) {
    if (reference[k] >= N_VARIABLES) return fmi2Error;
    value[k] = spring->value[reference[k]];
  }
  return fmi2OK;
}

EXPORTED fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference reference[], size_t n,
                                const fmi2Real value[]) {
  Spring* spring = c;
  for (size_t k = 0; k < n; k++) {
    const int is_speed = reference[k] == FRICTION_SPEED || reference[k] == LOSS_SPEED;
    if (reference[k] >= N_GIVEN || !isfinite(value[k]) || (is_speed && value[k] <= 0.0))
      return fmi2Error;
    spring->value[reference[k]] = value[k];
  }
  spring->is_current = 0;
  return fmi2OK;
}

#define NONE_OF(Type)                                                                      \
  ANSWER(Get##Type, n ? fmi2Error : fmi2OK, fmi2Component c, const fmi2ValueReference r[], \
         size_t n, fmi2##Type v[])                                                         \
  ANSWER(Set##Type, n ? fmi2Error : fmi2OK, fmi2Component c, const fmi2ValueReference r[], \
         size_t n, const fmi2##Type v[])
NONE_OF(Integer)
NONE_OF(Boolean)
NONE_OF(String)

/* What modelDescription.xml says is not available */

ANSWER(GetFMUstate, fmi2Error, fmi2Component c, fmi2FMUstate* state)
ANSWER(SetFMUstate, fmi2Error, fmi2Component c, fmi2FMUstate state)
ANSWER(FreeFMUstate, fmi2Error, fmi2Component c, fmi2FMUstate* state)
ANSWER(SerializedFMUstateSize, fmi2Error, fmi2Component c, fmi2FMUstate state, size_t* size)
ANSWER(SerializeFMUstate, fmi2Error, fmi2Component c, fmi2FMUstate state, fmi2Byte byte[],
       size_t size)
ANSWER(DeSerializeFMUstate, fmi2Error, fmi2Component c, const fmi2Byte byte[], size_t size,
       fmi2FMUstate* state)
ANSWER(GetDirectionalDerivative, fmi2Error, fmi2Component c, const fmi2ValueReference unknown[],
       size_t n_unknown, const fmi2ValueReference known[], size_t n_known, const fmi2Real change[],
       fmi2Real derivative[])

/* Co-simulation: outputs at the end of a step belong to the inputs there */

ANSWER(DoStep, fmi2OK, fmi2Component c, fmi2Real time, fmi2Real step,
       fmi2Boolean no_set_state_prior)
ANSWER(CancelStep, fmi2Error, fmi2Component c)
ANSWER(SetRealInputDerivatives, n ? fmi2Error : fmi2OK, fmi2Component c,
       const fmi2ValueReference reference[], size_t n, const fmi2Integer order[],
       const fmi2Real value[])
ANSWER(GetRealOutputDerivatives, n ? fmi2Error : fmi2OK, fmi2Component c,
       const fmi2ValueReference reference[], size_t n, const fmi2Integer order[], fmi2Real value[])

#define NO_STATUS(Name, Type) \
  ANSWER(Get##Name, fmi2Discard, fmi2Component c, const fmi2StatusKind kind, fmi2##Type* value)
NO_STATUS(Status, Status)
NO_STATUS(RealStatus, Real)
NO_STATUS(IntegerStatus, Integer)
NO_STATUS(BooleanStatus, Boolean)
NO_STATUS(StringStatus, String)

/* Model exchange: neither states nor events */

ANSWER(EnterEventMode, fmi2OK, fmi2Component c)
EXPORTED fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) {
  memset(info, 0, sizeof(*info));
  return fmi2OK;
}
ANSWER(EnterContinuousTimeMode, fmi2OK, fmi2Component c)
EXPORTED fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set_state_prior,
                                                fmi2Boolean* event, fmi2Boolean* terminate) {
  *event = *terminate = fmi2False;
  return fmi2OK;
}
ANSWER(SetTime, fmi2OK, fmi2Component c, fmi2Real time)
ANSWER(SetContinuousStates, n ? fmi2Error : fmi2OK, fmi2Component c, const fmi2Real x[], size_t n)
ANSWER(GetDerivatives, n ? fmi2Error : fmi2OK, fmi2Component c, fmi2Real derivative[], size_t n)
ANSWER(GetEventIndicators, n ? fmi2Error : fmi2OK, fmi2Component c, fmi2Real indicator[], size_t n)
ANSWER(GetContinuousStates, n ? fmi2Error : fmi2OK, fmi2Component c, fmi2Real x[], size_t n)
ANSWER(GetNominalsOfContinuousStates, n ? fmi2Error : fmi2OK, fmi2Component c, fmi2Real x[],
       size_t n)
