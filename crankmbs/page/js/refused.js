/** What cannot be, with the sentence that says why. */
export class Refused extends Error {}

/** Do something; the sentence why it cannot be, or null. */
export function refusalOf(does) {
  try {
    does();
  } catch (refused) {
    if (!(refused instanceof Refused)) throw refused;
    return refused.message;
  }
  return null;
}
