/** What cannot be, with the sentence that says why. */
export class Refused extends Error {}
